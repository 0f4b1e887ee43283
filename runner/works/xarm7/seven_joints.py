"""The report's second part made to work: the line by seven joints, tip position alone or with the orientation."""

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from runner.reporting.document import Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin, playback
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.quantities import above_rounding, number
from runner.reporting.run_values import measured
from runner.reporting.words import PRESET
from runner.store import Run
from runner.works.xarm7.rates import lag
from runner.works.xarm7.studies import smallest_margin
from runner.works.xarm7.three_joints import tip_curves

_TASKS = {"three_joints": "three joints", "seven_joints": "seven, position", "seven_joints_pose": "seven, pose"}


def seven_joints_section(runs: Mapping[str, Run]) -> Section:
    """Return the figures of the first part for all seven joints, and how both parts compare."""
    run = runs["seven_joints/sound"]
    controller = run.config["controller"]
    pair = [(_TASKS[name], runs[f"{name}/sound"]) for name in ("seven_joints", "seven_joints_pose")]
    return Section(
        "The line by seven joints",
        (
            Text(
                "The report gives no figure for its second part. What is run in its place, with the right Jacobian "
                "$J$ of 3 or 6 rows, is the pseudo-inverse of a wide matrix, with the tip's error fed back and what "
                "joints are to spare led towards home:"
            ),
            Formula(
                "dot(q) = J^+ (dot(x)_d + K (x_d - x)) + (I - J^+ J) dot(q)_0, quad J^+ = J^T (J J^T)^(-1)",
                "q dot equals J plus times desired velocity plus K times the tip error, plus the null-space "
                "projection of q dot zero; J plus equals J transposed times the inverse of J J transposed",
            ),
            Text(
                f"$K = {controller['gain']:g}$ 1/s, integrated over each period by the {controller['integration']} "
                "rule, joint and speed limits kept."
            ),
            tip_curves(pair),
            _joints(runs),
            playback(
                runs["seven_joints_pose/sound"],
                "The line by seven joints, orientation held, full equations: from A to B.",
                0.5 * float(run.config["trajectory"]["duration"]),
            ),
            _comparison(runs),
            _concluded(runs),
        ),
    )


def _joints(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for name, title in _TASKS.items():
        run = runs[f"{name}/sound"]
        t, q = run.trace["t"].to_numpy(), joint_columns(run.trace, "q")
        series = [Series(f"q{joint + 1}", t, q[:, joint]) for joint in range(q.shape[1])]
        panels.append(Panel(title.capitalize(), "time (s)", "joint position (rad)", series))
    return Curves("All joints over two periods, full equations.", panels, 3, origin(runs["seven_joints/sound"]))


def _comparison(runs: Mapping[str, Run]) -> Table:
    rows = []
    for preset in PRESETS:
        for name, title in _TASKS.items():
            run = runs[f"{name}/{preset}"]
            q = joint_columns(run.trace, "q")
            after = int(np.searchsorted(run.trace["t"].to_numpy(), float(run.config["trajectory"]["duration"]) - 1e-9))
            rows.append(
                [
                    PRESET[preset],
                    title,
                    *(above_rounding(run.metrics[m]["median"]) for m in ("max_tracking_error", "cross_track_error")),
                    smallest_margin(run),
                    number(run.metrics["peak_joint_speed"]["median"]),
                    above_rounding(_turned(run)),
                    above_rounding(float(np.abs(q[-1] - q[after]).max())),
                ]
            )
    return Table(
        "Three joints against seven.",
        [
            "preset",
            "joints",
            "tracking error (m)",
            "distance from the line (m)",
            "margin to a joint limit (rad)",
            "peak joint speed (rad/s)",
            "flange turned by (rad)",
            "drift of the joints in the second period (rad)",
        ],
        rows,
        (2, 3, 4, 5, 6, 7),
        origin(runs["seven_joints/as_reported"]),
    )


def _turned(run: Run) -> float:
    """Return the largest angle between the flange's orientation and the one it starts with, in rad."""
    model = model_of(run)
    q = joint_columns(run.trace, "q")
    first = model.tip_pose(q[0])[:3, :3]
    return max(float(np.linalg.norm(pin.log3(first.T @ model.tip_pose(row)[:3, :3]))) for row in q[::10])


def _concluded(runs: Mapping[str, Run]) -> Finding:
    late, ahead = (runs[f"seven_joints/{preset}"] for preset in PRESETS)
    three, pose = (runs[f"{name}/sound"] for name in ("three_joints", "seven_joints_pose"))
    apart = columns(ahead.trace, "tip") - columns(three.trace, "tip")
    frequency = 1.0 / float(late.config["controller"]["period"])
    return conclude(
        Measured("largest distance between the tips of both parts", float(np.linalg.norm(apart, axis=1).max()), "m"),
        measured(late, "max_tracking_error", "tip error without feedforward"),
        Measured("speed over K, by the midpoint rule", lag(late, frequency), "m"),
        measured(late, "cross_track_error", "distance from the line without feedforward"),
        measured(ahead, "max_tracking_error", "tip error with feedforward"),
        Measured("turn of the flange, seven joints, pose", _turned(pose), "rad"),
        Measured("turn of the flange, three joints", _turned(three), "rad"),
        [measured(run, "peak_joint_speed", "fastest joint's speed") for run in (ahead, pose, three)],
    )


def conclude(
    apart: Measured,
    late: Measured,
    closed_form: Measured,
    off: Measured,
    ahead: Measured,
    held: Measured,
    turned: Measured,
    speeds: Sequence[Measured],
) -> Finding:
    """Return how the line by seven joints compares with that by three.

    Args:
        apart: Largest distance between the tips of both, with feedforward.
        late: Tip error of seven joints without feedforward.
        closed_form: The lag that the speed and K ask for.
        off: Their distance from the line without feedforward.
        ahead: Their tip error with feedforward.
        held: Largest turn of the flange where its orientation is held.
        turned: The same by three joints.
        speeds: The fastest joint's speed for the position, for the pose, and where three joints move.
    """
    return finding(
        "Seven joints give the results that the report expected",
        f"The two parts' tips are at most {apart} apart (full equations). Without feedforward the tip lags by {late}, "
        f"the speed over $K$, and stays within {off} of the line; with it the error is {ahead}. Seven joints can also "
        f"hold the flange's orientation, which turns by {held} then; where three move it turns by {turned}. The "
        f"fastest joint turns at {speeds[0]} for the position, {speeds[1]} for the pose, and {speeds[2]} where only "
        "three move.",
        apart < 1e-5,
        late.near(closed_form, 0.02),
        off < 0.01 * late,
        ahead < 0.01 * late,
        held < 1e-4 * turned,
        turned > 0.1,
    )
