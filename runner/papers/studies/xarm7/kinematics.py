"""Printed kinematics compared with the model: tip position, inverse kinematics and its branches."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.studies.xarm7.equations.derivations.xarm7_inverse import CENTIMETRES, printed_inverse, printed_tip
from runner.papers.studies.xarm7.parts.three_joint_kinematics import BRANCHES, MOVING, Branch, ThreeJointArm
from runner.papers.study.results import Runs
from runner.reporting.table import Number
from runner.robots.model import RobotModel
from runner.store import Run


def random_postures(model: RobotModel, count: int, seed: int = 0) -> FloatArray:
    """Return postures spread evenly over the joint limits, shape (count, nq), in rad; always the same ones."""
    low, high = model.position_limits
    return np.random.default_rng(seed).uniform(low, high, (count, model.nq))


_PLACES = 41  # along the line
_SHOULDER, _ELBOW = {1: "facing the point", -1: "turned away"}, {1: "plus", -1: "minus"}
_FIXED: dict[str, tuple[tuple[str, ...], float]] = {  # which formulas are put right, and what one metre is
    "as printed, lengths in cm": ((), CENTIMETRES),
    "as printed, lengths in m": ((), 1.0),
    "$q_2$ put right, in cm": (("q2",), CENTIMETRES),
    "$q_2$ put right, in m": (("q2",), 1.0),
    "$q_4$ put right": (("q4",), CENTIMETRES),
    "both put right": (("q2", "q4"), CENTIMETRES),
}


def off_the_model(runs: Runs, run: str, right: bool, count: int) -> tuple[float, float]:
    """Return the largest and the median distance of the printed tip, or of the right one, from a run's model, in m."""
    model = runs[run].model
    postures = random_postures(model, count)
    distances = np.linalg.norm(printed_tip(postures, right) - model.tip_positions(postures), axis=1)
    return float(distances.max()), float(np.median(distances))


def fixed_errors(runs: Runs, run: str) -> list[tuple[str, float, float, float]]:
    """Return the largest errors of q2, q4 and the tip along the line, for each way to put the formulas right."""
    arm, points, wrist = _arm(runs[run]), _line(runs[run]), float(runs[run].config["controller"]["wrist"])
    exact = _branch(runs[run], BRANCHES[0])[0][:, list(MOVING)]
    rows = []
    for case, (right, unit) in _FIXED.items():
        q = printed_inverse(points, wrist, right, unit)
        off = np.abs(q - exact).max(axis=0)
        apart = np.linalg.norm([arm.tip(*row) for row in q] - points, axis=1)
        rows.append((case, float(off[1]), float(off[2]), float(apart.max())))
    return rows


def branch_rows(runs: Runs, *names: str) -> list[list[str | float | Number]]:
    """Return branch, X, ranges of q2 and q4, smallest margin and its joint: a row for each branch and line."""
    return [_branch_row(runs[name], branch) for branch in BRANCHES for name in names]


def _branch_row(run: Run, branch: Branch) -> list[str | float | Number]:
    q, margins = _branch(run, branch)
    name = f"{_SHOULDER[branch.shoulder]}, {_ELBOW[branch.elbow]}"
    ranges = [Number(None, float(q[:, j].min()), float(q[:, j].max())) for j in MOVING[1:]]
    return [name, f"{_line(run)[0, 0]:g}", *ranges, float(margins.min()), f"q{int(np.argmin(margins)) + 1}"]


def branches_miss(*lines: Run) -> float:
    """Return the largest distance between the tip of any branch and the lines of some runs, in m."""
    return max(
        float(np.abs(run.model.tip_positions(_branch(run, branch)[0]) - _line(run)).max())
        for run in lines
        for branch in BRANCHES
    )


def _branch(run: Run, branch: Branch) -> tuple[FloatArray, FloatArray]:
    """Return the joint positions along a run's line, shape (K, nq), and the margin of each to its limits, (nq,)."""
    arm = _arm(run)
    q = np.array([arm.solve(point, branch) for point in _line(run)])
    return q, run.model.limit_margins(q).min(axis=0)


def _arm(run: Run) -> ThreeJointArm:
    return ThreeJointArm(run.model, float(run.config["controller"]["wrist"]))


def _line(run: Run) -> FloatArray:
    """Return points along a run's line from A to B, shape (K, 3), in m."""
    trajectory = run.config["trajectory"]
    return np.linspace(trajectory["start"], trajectory["goal"], _PLACES)
