"""At the limits of joints and reach: that the arm stays inside, how it stops, and what it says."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import clock
from runner.store import Run
from runner.works.meca500.plan import LIMITS

_TITLES = {
    "speed_limit": "pushed faster than joints turn",
    "joint_limit": "lifted against a joint's limit",
    "out_of_reach": "led out of reach",
}


def limits_section(runs: Mapping[str, Run]) -> Section:
    """Return three runs into limits: margins, speeds, the hardest stop, and the notices."""
    found = {name: runs[f"limit/{name}"] for name in LIMITS}
    rows = []
    for name, run in found.items():
        rows.append(
            [
                _TITLES[name],
                number(smallest_margin(run), rounding=ROUNDING),
                f"{number(100.0 * fastest(run), 4)} %",
                f"{number(100.0 * hardest_change(run))} %",
                f"{number(100.0 * nearest_singular(run))} %",
                "; ".join(map(_spoken, run.provenance["warnings"])),
            ]
        )
    return Section(
        "At the limits",
        (
            Text(
                "Without springs an arm gives way to a push up to the limits of its joints. Each joint's speed is "
                "bounded by its limit and by a share of what is left to its position limit, so that it nears that "
                "exponentially; near singular postures the inverse is damped. Where the joints cannot follow, the "
                "law is put where the arm is, and the run says what has held it back."
            ),
            Table(
                "Runs into limits: smallest margin to a position limit, largest speed and largest change of speed from "
                "tick to tick in the joint's speed limit, and smallest singular value of the Jacobian in that at the "
                "start.",
                ["run", "margin (rad)", "speed", "change per tick", "singular value", "what the run says"],
                rows,
                (1, 2, 3, 4),
                origin(found["joint_limit"]),
            ),
            _curves(found),
            limits_finding(**limits_values(runs)),
        ),
    )


def _spoken(warning: object) -> str:
    """Return a stored warning as a sentence of the report."""
    return str(warning).replace("the posture, singular or nearly so", "a posture at or near a singularity")


def limits_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on limits is about."""
    found = [runs[f"limit/{name}"] for name in LIMITS]
    telling = sum(any("has held the tool back" in str(text) for text in run.provenance["warnings"]) for run in found)
    return {
        "margin": Measured("smallest margin to a position limit", min(map(smallest_margin, found)), "rad"),
        "speed": Measured("largest speed over its limit", 100.0 * max(map(fastest, found)), "%"),
        "change": Measured("largest change of speed in a tick", 100.0 * max(map(hardest_change, found)), "%"),
        "told": Measured("runs that name what has held the tool back", telling),
        "count": Measured("runs into limits", len(found)),
    }


def limits_finding(margin: Measured, speed: Measured, change: Measured, told: Measured, count: Measured) -> Finding:
    """Return what arms do at the limits of joints and reach."""
    return finding(
        "No joint passes a limit, and the run says what has held the tool",
        f"No joint passes its position limit: the smallest margin is {margin.shown}. None is faster than its speed "
        f"limit (the fastest has {speed} of it), and none changes its speed by more than {change} of that from one "
        f"tick to the next. {told} of {count} runs name what has held the tool back, and when it first did.",
        margin > -ROUNDING,
        margin < 1.0,
        speed < 100.0 * (1.0 + 1e-6),
        change < 30.0,
        told >= count,
    )


def fastest(run: Run) -> float:
    """Return the largest speed of a joint, as a share of its limit."""
    return float((np.abs(joint_columns(run.trace, "dq")) / model_of(run).velocity_limits).max())


def smallest_margin(run: Run) -> float:
    """Return how close a joint comes to a position limit, in rad; below zero is beyond it."""
    return float(model_of(run).limit_margins(joint_columns(run.trace, "q")).min())


def hardest_change(run: Run) -> float:
    """Return the largest change of a joint's speed from tick to tick, as a share of its speed limit."""
    changes = np.abs(np.diff(joint_columns(run.trace, "dq"), axis=0)) / model_of(run).velocity_limits
    return float(changes.max())


def nearest_singular(run: Run) -> float:
    """Return the smallest singular value of the tip's Jacobian over a run, as a share of that at the start."""
    model = model_of(run)
    singular = [np.linalg.svd(model.tip_jacobian(q), compute_uv=False)[-1] for q in joint_columns(run.trace, "q")[::10]]
    return float(min(singular) / singular[0])


def _curves(found: Mapping[str, Run]) -> Curves:
    panels = []
    for name, run in found.items():
        model = model_of(run)
        share = joint_columns(run.trace, "dq") / model.velocity_limits
        series = [Series(f"joint {number}", clock(run), share[:, number - 1]) for number in (1, 2, 3, 5)]
        panels.append(Panel(_TITLES[name], "time (s)", "speed / limit", series))
    return Curves("Joint speeds at the limits, as shares of them.", panels, 2, origin(found["joint_limit"]))
