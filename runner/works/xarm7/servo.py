"""Tracking error against the stiffness of the joints' servos."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import above_rounding, number
from runner.reporting.run_values import cell, failures, measured, values
from runner.store import Run
from runner.works.xarm7.plan import FEEDBACKS, GRAVITY_COMPENSATION, STIFFNESSES
from runner.works.xarm7.studies import error_at_end, largest_error_at, rate

_COMPENSATED = {"true": "with gravity term", "false": "without"}


def sag(run: Run) -> float:
    """Return |J K^-1 G|, the tip's sag by the arm's weight, its largest axis over the postures of a run, in m."""
    model = model_of(run)
    stiffness = float(run.config["plant"]["servo"]["stiffness"])
    rows = joint_columns(run.trace, "q")[::50]
    return max(float(np.abs(model.tip_jacobian(q)[:3] @ model.gravity_torque(q)).max()) / stiffness for q in rows)


def servo_section(runs: Mapping[str, Run]) -> Section:
    """Return tracking errors over the servos' stiffness, with and without gravity term, by what is fed back."""
    ours = {name: run for name, run in runs.items() if name.startswith("stiffness/")}
    first = runs[f"stiffness/{STIFFNESSES[0]:g}/false/commanded"]
    rows = [
        [
            f"{stiffness:g}",
            _COMPENSATED[compensation],
            feedback,
            cell(run, "max_tracking_error"),
            above_rounding(error_at_end(run)),
            number(sag(run)) if (compensation, feedback) == ("false", "commanded") else "–",
            cell(run, "peak_torque_q2"),
        ]
        for compensation in GRAVITY_COMPENSATION
        for feedback in FEEDBACKS
        for stiffness in STIFFNESSES
        for run in [_run(runs, stiffness, compensation, feedback)]
    ]
    servo = first.config["plant"]["servo"]
    half = 0.5 * float(first.config["trajectory"]["duration"])
    blocks: list[Block] = [
        Text(
            f"No stiffness of the arm's servos is published. The line from A to B in {half:g} s, commanded at "
            f"{rate(first)}, with servos of one stiffness $k$ at all joints, damping ratio "
            f"{servo['damping_ratio']:g}, a torque every {1e3 * servo['period']:g} ms, on PyBullet. The servos add the "
            "torques of gravity or do not; the law takes the tip's error where the joints are measured, or where they "
            "were commanded, which is open loop. A servo that has to hold the weight by its spring alone lets the tip "
            "sag by"
        ),
        Formula("x_d - x = J k^(-1) G", "the sag equals J times the inverse of k times G"),
        Table(
            "Errors by servo stiffness, from A to B.",
            [
                "stiffness (N m/rad)",
                "servo",
                "feedback",
                "largest error (m)",
                "error at B (m)",
                "sag, closed form (m)",
                "largest torque of q2 (N m)",
            ],
            rows,
            (0, 3, 4, 5, 6),
            origin(first),
        ),
        _curves(runs),
        _concluded(runs),
        *failures(ours),
    ]
    return Section("Tracking error against servo stiffness", blocks)


def _run(runs: Mapping[str, Run], stiffness: float, compensation: str, feedback: str) -> Run:
    return runs[f"stiffness/{stiffness:g}/{compensation}/{feedback}"]


def _curves(runs: Mapping[str, Run]) -> Curves:
    k = np.array(STIFFNESSES)
    panels = []
    for feedback in FEEDBACKS:
        series = [
            Series(
                _COMPENSATED[compensation],
                k,
                values((_run(runs, s, compensation, feedback) for s in STIFFNESSES), "max_tracking_error"),
                "points_line",
            )
            for compensation in GRAVITY_COMPENSATION
        ]
        if feedback == "commanded":
            closed = np.array([sag(_run(runs, s, "false", feedback)) for s in STIFFNESSES])
            series.append(Series("sag, closed form", k, closed, "dashed"))
        panels.append(
            Panel(
                f"Error taken at {feedback} joints",
                "stiffness (N m/rad)",
                "largest axis error (m)",
                series,
                x_log=True,
                y_log=True,
            )
        )
    return Curves(
        "Largest axis error against servo stiffness.",
        panels,
        2,
        origin(_run(runs, STIFFNESSES[0], "false", "commanded")),
    )


def _concluded(runs: Mapping[str, Run]) -> Finding:
    middle, stiff = STIFFNESSES[len(STIFFNESSES) // 2], STIFFNESSES[-1]

    def error(stiffness: float, compensation: str, feedback: str) -> Measured:
        name = f"largest axis error, {stiffness:g} N m/rad, {_COMPENSATED[compensation]}, {feedback}"
        return measured(_run(runs, stiffness, compensation, feedback), "max_tracking_error", name)

    open_loop, fed_back = (_run(runs, middle, "false", feedback) for feedback in ("commanded", "measured"))
    left = [
        Measured(
            f"error at B, {stiffness:g} N m/rad, open loop",
            error_at_end(_run(runs, stiffness, "false", "commanded")),
            "m",
        )
        for stiffness in STIFFNESSES
    ]
    return conclude(
        middle,
        error(middle, "false", "commanded"),
        Measured("sag by the closed form", sag(open_loop), "m"),
        error(middle, "true", "commanded"),
        error(stiff, "false", "commanded"),
        error(middle, "false", "measured"),
        Measured("time of that error", largest_error_at(fed_back), "s"),
        Measured("error at B, fed back", error_at_end(fed_back), "m"),
        error(middle, "true", "measured"),
        left,
    )


def conclude(
    middle: float,
    bare: Measured,
    closed_form: Measured,
    compensated: Measured,
    stiffer: Measured,
    fed_back: Measured,
    dropped: Measured,
    left: Measured,
    both: Measured,
    sags: Sequence[Measured],
) -> Finding:
    """Return what gravity term, stiffness and feedback are worth.

    Args:
        middle: The stiffness that is spoken of, in N m/rad.
        bare: Largest axis error in open loop without gravity term.
        closed_form: The sag at the same postures.
        compensated: Largest axis error in open loop with gravity term.
        stiffer: The same without it, with the largest stiffness tried.
        fed_back: Largest axis error fed back, without gravity term.
        dropped: When that is.
        left: What is left of it at B.
        both: Largest axis error fed back, with gravity term.
        sags: Error at B in open loop without gravity term, by stiffness.
    """
    stiffest = STIFFNESSES[-1]
    return finding(
        "The gravity term is worth more than stiffness, and feedback removes what is left at rest",
        f"At {middle:g} N m/rad the open loop without gravity term is off by {bare} (closed form at the same postures: "
        f"{closed_form}), with it by {compensated}; {stiffest:g} N m/rad without it leave {stiffer}. Fed back at the "
        f"measured joints it is {fed_back} without, as the arm drops at the start ({dropped} after it), with {left} "
        f"left at B, and {both} with it. The sag falls as the inverse of $k$: {sags[0]}, {sags[1]} and {sags[2]}. "
        "Feedback corrects it as integral action does, with the law's own $K$.",
        bare.near(closed_form, 0.05),
        compensated < 0.5 * stiffer,
        stiffer < bare,
        dropped < 0.25,
        left < 0.01 * fed_back,
        both < 0.1 * fed_back,
        *((STIFFNESSES[index] / STIFFNESSES[0] * each).near(sags[0], 0.1) for index, each in enumerate(sags) if index),
    )
