"""At the limits of joints and reach: that the arm stays inside, how it stops, and what it says."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.meca500.plan import LIMITS
from runner.reporting.quantities import number
from runner.reporting.run_values import clock
from runner.store import Run

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
        model = model_of(run)
        speeds = np.abs(joint_columns(run.trace, "dq")) / model.velocity_limits
        rows.append(
            [
                _TITLES[name],
                number(smallest_margin(run)),
                f"{100.0 * float(speeds.max()):.4g} %",
                f"{100.0 * hardest_change(run):.3g} %",
                f"{100.0 * nearest_singular(run):.3g} %",
                "; ".join(str(text) for text in run.provenance["warnings"]),
            ]
        )
    margin = min(smallest_margin(run) for run in found.values())
    hardest = max(hardest_change(run) for run in found.values())
    return Section(
        "At the limits",
        (
            Text(
                "Without springs, an arm goes where it is pushed until it cannot. Each joint's speed is bounded by its "
                "limit and by a share of what is left to its position limit, so that it nears that exponentially; "
                "near singular postures the inverse is damped. Where the joints cannot follow, the law is put where "
                "the arm is, and the run says what has held it back."
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
            Notice(
                "finding",
                "Never outside, and it says so",
                f"No joint passes its position limit: the smallest margin is {number(margin)} rad. None is faster than "
                "its speed limit, and none changes its speed by more than "
                f"{100.0 * hardest:.3g} % of that from one tick to the next. Each run names what has held the tool "
                "back, and when it first did.",
            ),
        ),
    )


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
