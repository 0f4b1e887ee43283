"""Tracking error against the stiffness of the joints' servos."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, failures, median, values
from runner.reporting.xarm7.studies import rate
from runner.reporting.xarm7.studies_plan import FEEDBACKS, GRAVITY_COMPENSATION, STIFFNESSES
from runner.store import Run

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
            _at_end(run),
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
            "torques of gravity or do not; our law takes the tip's error where the joints are measured, or where they "
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
        _finding(runs),
        *failures(ours),
    ]
    return Section("Tracking error against servo stiffness", blocks)


def _run(runs: Mapping[str, Run], stiffness: float, compensation: str, feedback: str) -> Run:
    return runs[f"stiffness/{stiffness:g}/{compensation}/{feedback}"]


def _at_end(run: Run) -> str:
    return number(float(np.abs(columns(run.trace, "error")[-1]).max()))


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


def _finding(runs: Mapping[str, Run]) -> Notice:
    middle = STIFFNESSES[len(STIFFNESSES) // 2]

    def error(compensation: str, feedback: str) -> str:
        return quantity(median(_run(runs, middle, compensation, feedback), "max_tracking_error"), "m")

    open_loop = _run(runs, middle, "false", "commanded")
    largest = median(open_loop, "max_tracking_error")
    apart = f"{100.0 * (largest / sag(open_loop) - 1.0):+.0f} %" if largest is not None else "–"
    return Notice(
        "finding",
        "The gravity term is worth more than stiffness, and feedback removes what is left at rest",
        f"At {middle:g} N m/rad the open loop without gravity term is off by {error('false', 'commanded')} (closed "
        f"form at the same postures: {apart}), with it by {error('true', 'commanded')}. Fed back at the measured "
        f"joints it is {error('false', 'measured')} without, most of it as the arm drops at the start, with "
        f"{_at_end(_run(runs, middle, 'false', 'measured'))} m left at B, and {error('true', 'measured')} with it. The "
        "sag falls as 1 / k; feedback corrects it as integral action does, with the law's own K.",
    )
