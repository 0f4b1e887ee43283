"""The report's kinematics against our own: table, transform and Jacobian, element by element."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from runner.reporting.document import FloatArray, Notice, Section, Table, Text
from runner.reporting.figures import model_of, origin
from runner.reporting.meca500.printed_kinematics import (
    MILLIMETRES,
    printed_jacobian,
    printed_transform,
    true_jacobian,
    true_transform,
)
from runner.reporting.quantities import number
from runner.robots.denavit_hartenberg import modified_frames
from runner.robots.meca500 import TABLE
from runner.robots.model import RobotModel
from runner.store import Run

_COUNT = 1000
_RIGHT = 1e-9  # mm, or 1: below it an element is right


def kinematics_section(runs: Mapping[str, Run]) -> Section:
    """Return Table 1 with and without its lost turns, and each printed element that can be read."""
    run = runs["plants/kinematic"]
    flange = RobotModel(run.urdf, "flange", run.config["gravity"])
    low, high = np.clip(model_of(run).position_limits, -np.pi, np.pi)
    postures = np.random.default_rng(0).uniform(low, high, (_COUNT, 6))
    return Section(
        "Kinematics, element by element",
        (
            Text(
                f"Everything here is worked out at {_COUNT} random postures within the joint limits, against the "
                "product of the modified D-H transforms of our table (that of the URDF, whose frames were built "
                "independently) and the joint axes $z_i$ that follow from it: $J_i = (z_i times (p_6 - p_i), z_i)$. "
                "Elements of which the text has lost parts are left out."
            ),
            _table_one(flange, postures, run),
            _transform(postures, run),
            _jacobian(postures, run),
            Notice(
                "finding",
                "The lengths and the transform are right; the angular rows are no velocity Jacobian",
                "Table 1 needs $theta_2 = q_2 - 90°$ and $theta_6 = q_6 + 180°$, which its text has lost. With them "
                'every readable element of $""_6^0 T$ is right, if "-C_2" is read as the factor '
                "$sin(theta_2 - 90°)$. Of the Jacobian the linear rows are right but for one root. The angular rows "
                "bear terms with a bare angle: they differentiate $theta_i z_i$ where the angular velocity is "
                "$sum z_i dot(theta)_i$. Without these terms every one is the joint's axis.",
            ),
        ),
    )


def _table_one(flange: RobotModel, postures: FloatArray, run: Run) -> Table:
    true = np.array([flange.tip_pose(q) for q in postures])
    rows = []
    for name, turned in {
        "with both turns": (),
        "without -90° of joint 2": (1,),
        "without 180° of joint 6": (5,),
        "as printed, without both": (1, 5),
    }.items():
        table = [replace(row, theta=0.0) if index in turned else row for index, row in enumerate(TABLE)]
        poses = np.array([modified_frames(table, q)[-1] for q in postures])
        off = np.linalg.norm(poses[:, :3, 3] - true[:, :3, 3], axis=1)
        cosine = np.clip((np.einsum("kij,kij->k", poses[:, :3, :3], true[:, :3, :3]) - 1.0) / 2.0, -1.0, 1.0)
        angle = np.degrees(np.arccos(cosine))
        rows.append([name, number(MILLIMETRES * float(off.mean())), number(MILLIMETRES * float(off.max())),
                     number(float(angle.mean()), 3) if angle.max() > 1e-5 else "0"])  # fmt: skip
    return Table(
        "Table 1 as a modified D-H table, against the arm's URDF.",
        ["table", "mean distance of frame 6 (mm)", "largest (mm)", "mean turn (degrees)"],
        rows,
        (1, 2, 3),
        origin(run, "Table 1"),
    )


Elements = Callable[[FloatArray], dict[tuple[int, int], float]]


def _errors(printed: Elements, true: Callable[[FloatArray], FloatArray], postures: FloatArray) -> dict[str, float]:
    """Return the largest difference of each element, by its indices as printed."""
    errors: dict[str, float] = {}
    for q in postures:
        matrix = true(q)
        for (row, column), value in printed(q).items():
            key = f"{row}{column}"
            errors[key] = max(errors.get(key, 0.0), abs(value - float(matrix[row, column])))
    return errors


def _verdict(error: float) -> str:
    return "right" if error < _RIGHT else f"off by up to {number(error)}"


def _transform(postures: FloatArray, run: Run) -> Table:
    literal = _errors(lambda q: printed_transform(q, factor=False), true_transform, postures)
    read = _errors(lambda q: printed_transform(q, factor=True), true_transform, postures)
    rows = [[f"T_{key}", _verdict(literal[key]), _verdict(read[key]), number(read[key])] for key in read]
    return Table(
        "Elements of the transform, section 7.1; lengths in mm.",
        ["element", '"-C_2" a term', '"-C_2" a factor', "largest difference then"],
        rows,
        (3,),
        origin(run, "7.1"),
    )


def _jacobian(postures: FloatArray, run: Run) -> Table:
    literal = _errors(lambda q: printed_jacobian(q, angles=True), true_jacobian, postures)
    axes = _errors(lambda q: printed_jacobian(q, angles=False), true_jacobian, postures)
    mended = _errors(lambda q: printed_jacobian(q, angles=False, root=4.0 * 3961.0), true_jacobian, postures)
    rows = []
    for key in literal:
        what = "nothing"
        if literal[key] >= _RIGHT:
            what = "the terms with a bare angle" if axes[key] < _RIGHT else "$sqrt(23961)$ for $2 sqrt(3961)$"
        rows.append([f"J_a6,{key}", _verdict(literal[key]), what, number(mended[key])])
    return Table(
        "Elements of the Jacobian in frame 6, sections 1 and 7.2; linear rows (0 to 2) in mm.",
        ["element", "as printed", "what is wrong", "largest difference, put right"],
        rows,
        (3,),
        origin(run, "7.2"),
    )
