"""Reference derivations of the Meca500's kinematics: URDF by Pinocchio, and the report's D-H table after emendation.

The manufacturer's description, `report.urdf`, has all frames parallel at q = 0, with joint axes z, y, y, x, y, x. The
frames of the report differ; the URDF defines each of them in the manufacturer's frame of the same joint. The report's
Denavit-Hartenberg table uses the modified (Craig) convention. Lengths in mm, as in the report.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import (
    Derivations,
    Elements,
    Symbols,
    columns,
    jacobian_by_differences,
    product,
    rotation,
    translation,
    whole_and_elements,
)
from runner.papers.audit.model_derivations import audited_arm, by_model

JOINTS = 6
_Matrices = Callable[[FloatArray], FloatArray]
_HALF = np.pi / 2


@dataclass(frozen=True)
class ModifiedRow:
    """Row of a modified (proximal, Craig's) D-H table: joint i turns about z_i, and frame i is on the axis of joint i.

    Attributes:
        alpha: Angle from z_{i-1} to z_i about x_{i-1}, in rad.
        a: Distance from z_{i-1} to z_i along x_{i-1}, in mm.
        theta: Angle from x_{i-1} to x_i about z_i at q_i = 0, in rad; the joint position is added to it.
        d: Distance from x_{i-1} to x_i along z_i, in mm.
    """

    alpha: float
    a: float
    theta: float
    d: float


TABLE = (
    ModifiedRow(alpha=0.0, a=0.0, theta=0.0, d=135.0),
    ModifiedRow(alpha=-_HALF, a=0.0, theta=-_HALF, d=0.0),
    ModifiedRow(alpha=0.0, a=135.0, theta=0.0, d=0.0),
    ModifiedRow(alpha=-_HALF, a=38.0, theta=0.0, d=120.0),
    ModifiedRow(alpha=_HALF, a=0.0, theta=0.0, d=0.0),
    ModifiedRow(alpha=-_HALF, a=0.0, theta=np.pi, d=70.0),
)
"""The report's Table 1 with the turns that its text has lost and its own elements need: theta_2 stands for q_2 - 90 deg
(without it the tip is 0.34 m off on average), theta_6 for q_6 + 180 deg. Frame 6 is the flange's, z outwards."""

ARM = audited_arm("report.urdf", "frame6", tuple(f"theta{i + 1}" for i in range(JOINTS)), Path(__file__).parents[2])
"""The arm by the maker's joints, its lengths in mm; the tip is the report's frame 6."""

BY_MODEL = by_model(ARM.model)
"""Its kinematics by Pinocchio."""


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return the values of the report's names at random configurations, each joint drawn from a full turn.

    `theta1` to `theta6` are the joint positions in rad, `S1`, `C1` and so on their sines and cosines, `S23`, `C23` of
    the sum of the second and third. `R_6` and `P_6` are rotation and origin of frame 6, `T_55` frame 5 in itself.
    """
    q = generator.uniform(-np.pi, np.pi, (count, JOINTS))
    values = {f"theta{i + 1}": q[:, i] for i in range(JOINTS)}
    values |= {f"S{i + 1}": np.sin(q[:, i]) for i in range(JOINTS)}
    values |= {f"C{i + 1}": np.cos(q[:, i]) for i in range(JOINTS)}
    T, degree = BY_MODEL.pose(q), np.full(count, np.pi / 180)
    blocks = {"R_6": T[:, :3, :3], "P_6": T[:, :3, 3], "T_55": np.tile(np.eye(4), (count, 1, 1)), "degree": degree}
    return values | blocks | {"S23": np.sin(q[:, 1] + q[:, 2]), "C23": np.cos(q[:, 1] + q[:, 2])}


def positions(values: Symbols) -> FloatArray:
    """Return the joint positions of a sample, shape (T, 6), in rad."""
    return columns(values, ARM.joints)


def row_transform(row: ModifiedRow, angle: FloatArray) -> FloatArray:
    """Return the transform of one row of a modified Denavit-Hartenberg table, shape (T, 4, 4), in mm."""
    turn, shift = rotation("z", angle + row.theta), translation("z", row.d)
    return product([rotation("x", row.alpha), translation("x", row.a), turn, shift])


def frames(q: FloatArray, table: Sequence[ModifiedRow] = TABLE) -> list[FloatArray]:
    """Return the transforms of frames 1 to n in the base frame by a table, shape (T, 4, 4) each, in mm."""
    result: list[FloatArray] = []
    for i, row in enumerate(table):
        step = row_transform(row, q[:, i])
        result.append(result[-1] @ step if result else step)
    return result


def pose(q: FloatArray) -> FloatArray:
    """Return the transform of frame 6 in the base frame by the emended table, shape (T, 4, 4), in mm."""
    return frames(q)[-1]


def in_frame_6(jacobians: FloatArray, poses: FloatArray) -> FloatArray:
    """Return Jacobians of the base frame seen from frame 6, shape (T, 6, 6)."""
    turned = poses[:, :3, :3].transpose(0, 2, 1)
    return np.concatenate([turned @ jacobians[:, :3], turned @ jacobians[:, 3:]], axis=1)


def _steps_by_model(values: Symbols) -> Elements:
    names = ("link0", *(f"frame{i + 1}" for i in range(JOINTS)))
    each = np.array([ARM.model.frame_poses(row, names) for row in positions(values)])
    between = np.linalg.inv(each[:, :-1]) @ each[:, 1:]
    return {f"T_{i + 1}": between[:, i] for i in range(JOINTS)}


def _steps_by_table(values: Symbols) -> Elements:
    q = positions(values)
    return {f"T_{i + 1}": row_transform(row, q[:, i]) for i, row in enumerate(TABLE)}


steps = Derivations(_steps_by_model, _steps_by_table, ("Pinocchio, the maker's joints", "the emended table"))


def _both(letter: str, by_model: _Matrices, by_table: _Matrices, table: str) -> Derivations:
    """Return derivations of a matrix whose elements the report counts from 0."""
    return Derivations(
        lambda values: whole_and_elements(letter, by_model(positions(values)), 0),
        lambda values: whole_and_elements(letter, by_table(positions(values)), 0),
        ("Pinocchio, the maker's joints", table),
    )


def jacobian_by_table(q: FloatArray) -> FloatArray:
    """Return the basic Jacobians in the base frame by differences of the emended table, shape (T, 6, 6), in mm/rad."""
    return jacobian_by_differences(pose, q)


transform = _both("T", BY_MODEL.pose, pose, "product of the emended table")
jacobian = _both("J_g0", BY_MODEL.jacobian, jacobian_by_table, "differences of the emended table's product")
jacobian_6 = _both(
    "J_g6",
    lambda q: in_frame_6(BY_MODEL.jacobian(q), BY_MODEL.pose(q)),
    lambda q: in_frame_6(jacobian_by_table(q), pose(q)),
    "differences of the emended table's product, turned",
)
