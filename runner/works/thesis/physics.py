"""Whether the simulation itself can be trusted: two plants, sampling limits, similarity."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from runner.claims import load_claims
from runner.reporting.document import Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.plant_agreement import disagreement
from runner.reporting.quantities import number
from runner.reporting.run_values import cell, measured
from runner.store import Run
from runner.works.thesis.plan import ARMS, SAMPLING, STEPS


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
        tip = number(disagreement(run, reference).tip)
        rows.append([f"{step:g}", number(difference), ratio, tip, cell(run, "max_tracking_error")])
    rows.append(["Runge-Kutta", "–", "–", "–", cell(reference, "max_tracking_error")])
    steps = np.array(STEPS)
    order_one = differences[0] * steps / steps[0]
    return Section(
        "PyBullet against Runge-Kutta",
        (
            Text(
                "PyBullet integrates by semi-implicit Euler, of first order; the Runge-Kutta plant is of fourth. A "
                "noise-free, unlimited quintic of 2 s with ever smaller steps of PyBullet, against Runge-Kutta."
            ),
            Table(
                "Difference of the final joint positions, largest distance of the tips during the motion, and largest "
                "tracking error.",
                [
                    "PyBullet's step (s)",
                    "final difference (rad)",
                    "ratio to the step before",
                    "largest tip distance (m)",
                    "largest tracking error (m)",
                ],
                rows,
                (0, 1, 2, 3, 4),
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
            _first_order(differences),
            _integrator(runs),
        ),
    )


def _first_order(differences: Sequence[float]) -> Finding:
    found = [
        Measured(f"difference of the final state, step {number(1e3 * step)} ms", difference, "rad")
        for step, difference in zip(STEPS, differences, strict=True)
    ]
    return finding(
        "PyBullet comes to the Runge-Kutta plant in proportion to its step",
        f"Each halving of its step halves the difference, from {found[0]} to {found[-1]}.",
        *(after.near(0.5 * before, 0.05) for before, after in pairwise(found)),
    )


def _integrator(runs: Mapping[str, Run]) -> Finding:
    errors = [
        measured(runs[f"plants/{step}"], "max_tracking_error", f"tracking error, step {number(1e3 * step)} ms")
        for step in STEPS
    ]
    exact = measured(runs["plants/rk4"], "max_tracking_error", "tracking error, Runge-Kutta")
    share = STEPS[0] / float(runs["plants/rk4"].config["controller"]["period"])
    return finding(
        "Without noise a tracking error holds an error of PyBullet's own",
        f"With a step of {number(share)} control periods, the default, PyBullet's largest tracking error is "
        f"{errors[0]}; solved by Runge-Kutta it is {exact}, and {errors[-1]} at PyBullet's smallest step. Without "
        "noise laws are to be compared and tuned on plant=rk4, or with a smaller plant.step; else the integrator is "
        "tuned, too.",
        errors[0] > 1.05 * exact,
        *(after - exact < 0.75 * (before - exact) for before, after in pairwise(errors)),
        errors[-1].near(exact, 0.03),
    )


def sampling_section(runs: Mapping[str, Run]) -> Section:
    """Return decay and growth around the sampling limit."""
    series = []
    for w in SAMPLING:
        trace = runs[f"sampling/{w}"].trace
        error = np.linalg.norm(columns(trace, "error"), axis=1)
        shown = (trace["t"].to_numpy() <= 2.0) & (error > 0.0)
        series.append(Series(f"ωₙh = {w:g}", trace["t"].to_numpy()[shown], error[shown]))
    limits = {arm: _period_limit(runs[f"{figure}/sound"]) for arm, figure in zip(ARMS, _GOALS, strict=True)}
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
                f"that is h < {number(limits['macro'][0], 2)} ms for the Macro and {number(limits['mini'][0], 2)} ms "
                f"for the Mini. The thesis' {number(limits['macro'][1])} ms and {number(limits['mini'][1])} ms keep a "
                f"factor of {number(limits['macro'][0] / limits['macro'][1], 2)} and "
                f"{number(limits['mini'][0] / limits['mini'][1], 2)}."
            ),
            Curves(
                f"A goal step of a millimetre at {len(SAMPLING)} controller periods, Runge-Kutta plant.",
                (Panel("", "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 10.0)),),
                1,
                origin(runs[f"sampling/{SAMPLING[2]}"]),
            ),
            _stable(runs),
        ),
    )


_GOALS = ("figure_3_5", "figure_4_2")


def _period_limit(run: Run) -> tuple[float, float]:
    """Return the longest stable period of an arm under exact integration, and its own, in ms."""
    controller = run.config["controller"]
    return 1e3 / float(controller["natural_frequency"]), 1e3 * float(controller["period"])


def _stable(runs: Mapping[str, Run]) -> Finding:
    growths = {}
    for w in SAMPLING:
        error = np.linalg.norm(columns(runs[f"sampling/{w}"].trace, "error"), axis=1)
        growths[w] = Measured(
            f"error at the end over that at the start, $omega_n h$ = {w:g}", float(error[-1] / error[0])
        )
    below, above = [w for w in SAMPLING if w < 1.0], [w for w in SAMPLING if w > 1.0]
    return finding(
        "Below the limit a deviation vanishes, above it grows",
        f"With $omega_n h$ = {', '.join(f'{w:g}' for w in below)} the deviation vanishes; with "
        f"{', '.join(f'{w:g}' for w in above)} it grows to {', '.join(str(growths[w]) for w in above)} times the step.",
        *(growths[w] < 1e-3 for w in below),
        *(growths[w] > 10.0 for w in above),
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
                "apart from gravity. Both arms on the goal move without gravity and noise:"
            ),
            Curves(
                "Tip error of the goal move without gravity and noise; the Mini's times and lengths are scaled by 10.",
                (Panel("", "Macro time (s)", "error (m)", curves),),
                1,
                origin(mini),
            ),
            _similar(runs, apart, torque),
        ),
    )


def _similar(runs: Mapping[str, Run], apart: float, torque: float) -> Finding:
    joints = Measured("largest difference of the joint positions at equal ticks", apart, "rad")
    torques = Measured("largest difference of the torques, scaled", torque, "N m")
    macro, mini = (measured(runs[f"similarity/{arm}"], "settling_time", f"settling time of the {arm}") for arm in ARMS)
    claims = {claim.number: claim for claim in load_claims("thesis")}
    printed_macro, printed_mini = (
        Measured(f"printed settling time of the {arm}", claims[claim].printed[0], "s")
        for arm, claim in zip(ARMS, (1, 5), strict=True)
    )
    return finding(
        "Without gravity and noise the Mini does what the Macro does, ten times faster",
        f"The joint positions at equal ticks differ by {joints} at most, the scaled torques by {torques}; the arms "
        f"settle after {macro} and {mini}. Claim 5, a Mini that takes {printed_mini} where the Macro takes "
        f"{printed_macro}, is not of one and the same law: of the printed times the Mini's is "
        f"{printed_mini / printed_macro} of the Macro's.",
        joints < 1e-9,
        torques < 1e-6,
        macro.near(10.0 * mini, 0.02),
        printed_mini / printed_macro > 1.5 * (mini / macro),
    )
