"""What explains the thesis' errors: the missing gravity term, and the missing feedforward."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.quantities import number, quantity
from runner.reporting.thesis.plan import ARMS, LAG_DURATIONS
from runner.store import Run


def gravity_section(runs: Mapping[str, Run]) -> Section:
    """Return the sag of a controller without gravity term, closed form against simulation."""
    rows = []
    for arm in ARMS:
        run = runs[f"gravity_term/{arm}"]
        measured = float(np.linalg.norm(columns(run.trace, "error")[-1]))
        predicted = float(np.linalg.norm(_sag(run)))
        rows.append([arm, number(predicted, 4), number(measured, 4), f"{100.0 * (measured / predicted - 1.0):+.2f} %"])
    goal = runs["figure_3_5/as_reported"].metrics["steady_state_error"]
    blocks: list[Block] = [
        Text(
            "A proportional-derivative law in operational space that lacks the term $hat(p)(x)$ comes to rest where "
            "its proportional part carries the weight:"
        ),
        Formula("x_d - x = 1 / omega_n^2 J M^(-1) G", "the error at rest equals J M inverse G over omega n squared"),
        Table(
            "Norm of the tip's sag at the end of a noise-free quintic, without gravity term; the closed form at the "
            "run's final true $q$.",
            ["arm", "closed form (m)", "simulated (m)", "difference"],
            rows,
            (1, 2, 3),
            origin(runs["gravity_term/macro"]),
        ),
        Notice(
            "finding",
            "The thesis' steady-state errors are gravity, not noise",
            f"The goal run of figure 3.5 without gravity term rests at {quantity(goal['median'], 'm')} "
            f"({number(goal['min'])} to {number(goal['max'])} over the seeds), the thesis prints 0 to 9·10⁻³ m. By "
            "similarity the ratio of Macro to Mini is 1000 for encoder noise and 100 for gravity; the thesis "
            "reports 150. So its controller left out the gravity term that its equation (3.32) contains.",
        ),
    ]
    return Section("The gravity term", blocks)


def _sag(run: Run) -> np.ndarray:
    """Return J M^-1 G / omega_n^2 at the run's final true joint positions, shape (3,), in m."""
    model = model_of(run)
    q = joint_columns(run.trace, "q")[-1]
    wn = run.config["controller"]["natural_frequency"]
    sag: np.ndarray = model.tip_jacobian(q)[:3] @ np.linalg.solve(model.mass_matrix(q), model.gravity_torque(q)) / wn**2
    return sag


def lag_section(runs: Mapping[str, Run]) -> Section:
    """Return the lag of a controller without feedforward, closed form against simulation."""
    rows, series = [], []
    for index, arm in enumerate(ARMS):
        pairs = []
        for t_f in LAG_DURATIONS:
            run = runs[f"lag/{arm}/{t_f}"]
            measured = float(np.linalg.norm(columns(run.trace, "error"), axis=1).max())
            predicted = _lag(run, t_f)
            pairs.append((measured, predicted))
            rows.append(
                [
                    arm,
                    f"{t_f:g}",
                    number(predicted, 4),
                    number(measured, 4),
                    f"{100.0 * (measured / predicted - 1.0):+.2f} %",
                ]
            )
        t = np.array(LAG_DURATIONS)
        series.append(Series(f"{arm}, closed form", t, np.array([p for _, p in pairs]), "dashed", color=index))
        series.append(Series(f"{arm}, simulated", t, np.array([m for m, _ in pairs]), "points", color=index))
    run = runs[f"lag/macro/{LAG_DURATIONS[2]}"]
    blocks: list[Block] = [
        Text(
            "Without desired velocity and acceleration the goal law chases a moving goal. Its tip lags by the "
            "velocity times $2 xi slash omega_n$; the quintic's largest velocity is $1.875 D slash t_f$:"
        ),
        Formula(
            "max |x_d - x| = (2 xi) / omega_n (1.875 |D|) / t_f",
            "largest lag equals 2 xi over omega n times 1.875 D over t f",
        ),
        Table(
            "Largest norm of the tip error, noise-free, gravity compensated, no torque limit, without feedforward.",
            ["arm", "$t_f$ (s)", "closed form (m)", "simulated (m)", "difference"],
            rows,
            (1, 2, 3, 4),
            origin(run),
        ),
        Curves(
            "Lag against duration: the closed form and the simulation.",
            (Panel("", "duration (s)", "largest error norm (m)", series, y_log=True),),
            1,
            origin(run),
        ),
        Text(
            "The Mini's error of 4·10⁻⁴ to 8·10⁻⁴ m in the thesis is this lag at $t_f = 3$ s, 7.3·10⁻⁴ m on its "
            "worst axis. So its tracking law, too, was the goal law with a moving goal, not (3.40) with its "
            "feedforward."
        ),
    ]
    return Section("The lag", blocks)


def _lag(run: Run, t_f: float) -> float:
    controller = run.config["controller"]
    desired = columns(run.trace, "desired")
    distance = float(np.linalg.norm(desired[-1] - desired[0]))
    rate = float(controller["natural_frequency"])
    return 2.0 * float(controller["damping_ratio"]) / rate * 1.875 * distance / t_f
