"""Whether the simulation itself can be trusted: two plants, sampling limits, similarity."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, origin
from runner.reporting.plant_agreement import disagreement
from runner.reporting.quantities import number
from runner.reporting.thesis.plan import SAMPLING, STEPS
from runner.store import Run


def plants_section(runs: Mapping[str, Run]) -> Section:
    """Return how PyBullet approaches the Runge-Kutta plant as its step shrinks."""
    reference = runs["plants/rk4"]
    final = joint_columns(reference.trace, "q")[-1]
    rows: list[list[str]] = []
    differences: list[float] = []
    for step in STEPS:
        run = runs[f"plants/{step}"]
        difference = float(np.linalg.norm(joint_columns(run.trace, "q")[-1] - final))
        ratio = f"{difference / differences[-1]:.3f}" if differences else "–"
        differences.append(difference)
        rows.append([f"{step:g}", number(difference), ratio, number(disagreement(run, reference).tip)])
    steps = np.array(STEPS)
    order_one = differences[0] * steps / steps[0]
    return Section(
        "PyBullet against Runge-Kutta",
        (
            Text(
                "PyBullet integrates by semi-implicit Euler, of first order; the Runge-Kutta plant is of fourth. On "
                "a noise-free, unlimited quintic of 2 s each halving of PyBullet's step should halve the difference "
                "of the final state."
            ),
            Table(
                "Difference of the final joint positions, and largest distance of the tips during the motion.",
                [
                    "PyBullet's step (s)",
                    "final difference (rad)",
                    "ratio to the step before",
                    "largest tip distance (m)",
                ],
                rows,
                (0, 1, 2, 3),
                origin(runs[f"plants/{STEPS[0]}"]),
            ),
            Curves(
                "Convergence of PyBullet to the Runge-Kutta plant.",
                (
                    Panel(
                        "",
                        "step (s)",
                        "final difference (rad)",
                        (
                            Series("simulated", steps, np.array(differences), "points_line"),
                            Series("first order", steps, order_one, "dotted"),
                        ),
                        x_log=True,
                        y_log=True,
                    ),
                ),
                1,
                origin(runs[f"plants/{STEPS[0]}"]),
            ),
        ),
    )


def sampling_section(runs: Mapping[str, Run]) -> Section:
    """Return decay and growth around the sampling limit."""
    series = []
    for w in SAMPLING:
        trace = runs[f"sampling/{w}"].trace
        error = np.linalg.norm(columns(trace, "error"), axis=1)
        shown = (trace["t"].to_numpy() <= 2.0) & (error > 0.0)
        series.append(Series(f"ωₙh = {w:g}", trace["t"].to_numpy()[shown], error[shown]))
    growing = runs[f"sampling/{SAMPLING[-1]}"]
    ending = "its deviation grows from tick to tick" + (" until it diverges" if growing.status == "failed" else "")
    return Section(
        "How slowly the controller may be sampled",
        (
            Text("With torques held over the period h and exact velocities, critical damping is stable for"),
            Formula(
                'omega_n h < 1 quad "(exact integration)", quad 4 - 4 w - w^2 / n > 0, w = omega_n h quad '
                '"(semi-implicit Euler, n steps)"',
                "omega n h below one; with Euler 4 minus 4 w minus w squared over n above zero",
            ),
            Text(
                "that is h < 33 ms for the Macro and 3.3 ms for the Mini. The thesis' 10 ms and 1 ms keep a factor "
                "of three."
            ),
            Curves(
                f"A goal step of a millimetre at four controller periods, Runge-Kutta plant. Above the limit {ending}.",
                (Panel("", "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 10.0)),),
                1,
                origin(runs[f"sampling/{SAMPLING[2]}"]),
            ),
        ),
    )


def similarity_section(runs: Mapping[str, Run]) -> Section:
    """Return the Mini as the Macro scaled, without gravity."""
    macro, mini = runs["similarity/macro"], runs["similarity/mini"]
    # The Mini lives ten times faster: its tick k is the Macro's tick k.
    rows = min(len(macro.trace), len(mini.trace))
    a, b = macro.trace[:rows], mini.trace[:rows]
    apart = float(np.abs(joint_columns(a, "q") - joint_columns(b, "q")).max())
    torque = float(np.abs(joint_columns(a, "tau") - 10.0 * joint_columns(b, "tau")).max())
    t = a["t"].to_numpy()
    error, scaled = columns(a, "error"), 10.0 * columns(b, "error")
    settled = [run.metrics["settling_time"]["median"] for run in (macro, mini)]
    curves = [
        series
        for i, axis in enumerate("xyz")
        for series in (
            Series(f"Macro {axis}", t, error[:, i], color=i),
            Series(f"Mini {axis} × 10", t, scaled[:, i], "dotted", color=i),
        )
    ]
    return Section(
        "The Mini is the Macro, scaled",
        (
            Text(
                "Lengths 0.1, masses 0.1, times 0.1 and torques 0.1 leave the equations of motion as they are, "
                "apart from gravity. Without gravity and noise the two arms' joint positions at equal ticks differ "
                f"by at most {apart:.1e} rad and their torques (scaled) by {torque:.1e} N m; they settle after "
                f"{number(settled[0])} and {number(settled[1])} s. This is why claim 5, a Mini that takes 0.3 s "
                "where the Macro takes 1.4 s, cannot be met by any choice left open."
            ),
            Curves(
                "Tip error of the goal move without gravity and noise; the Mini's times and lengths are scaled by 10.",
                (Panel("", "Macro time (s)", "error (m)", curves),),
                1,
                origin(mini),
            ),
        ),
    )
