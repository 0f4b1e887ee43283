"""The Meca500's kinematics: the maker's joints by Pinocchio, and the report's Denavit-Hartenberg table mended.

The maker's description has all frames parallel at q = 0, with joint axes z, y, y, x, y, x. The report's frames stand
otherwise; `_FRAMES` says how each lies in the maker's frame of the same joint. Its table is of the modified (Craig)
convention. Lengths in mm, as the report has them.
"""

from collections.abc import Callable
from functools import cache

import numpy as np

from runner.audit.chains import (
    chain_model,
    jacobian_by_differences,
    placed,
    product,
    rotation,
    translation,
)
from runner.audit.truth import Elements, FloatArray, Symbols, Truth
from runner.robots.model import RobotModel

JOINTS = 6
_HALF = np.pi / 2

TABLE = (  # alpha before the joint, a before the joint, offset of the angle, d: degrees turned into rad, mm
    (0.0, 0.0, 0.0, 135.0),
    (-_HALF, 0.0, -_HALF, 0.0),
    (0.0, 135.0, 0.0, 0.0),
    (-_HALF, 38.0, 0.0, 120.0),
    (_HALF, 0.0, 0.0, 0.0),
    (-_HALF, 0.0, np.pi, 70.0),
)
"""The report's table with the offsets that its own elements need: -90 degrees at joint 2, 180 degrees at joint 6."""

_ORIGINS = ((0, 0, 135), (0, 0, 0), (0, 0, 135), (0, 0, 38), (120, 0, 0), (70, 0, 0))
_AXES = "zyyxyx"
_FRAMES = tuple(  # columns: the report's x, y, z axes in the maker's frame; then its origin there
    placed(origin, np.array([[*row, 0] for row in rows] + [[0, 0, 0, 1]], dtype=float))
    for rows, origin in (
        (((1, 0, 0), (0, 1, 0), (0, 0, 1)), (0, 0, 0)),
        (((0, 1, 0), (0, 0, 1), (1, 0, 0)), (0, 0, 0)),
        (((0, 1, 0), (0, 0, 1), (1, 0, 0)), (0, 0, 0)),
        (((0, 0, 1), (0, -1, 0), (1, 0, 0)), (120, 0, 0)),
        (((0, 1, 0), (0, 0, 1), (1, 0, 0)), (0, 0, 0)),
        (((0, 0, 1), (0, 1, 0), (-1, 0, 0)), (0, 0, 0)),
    )
)


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return what the report's names stand for at random configurations, each joint drawn from a full turn.

    `theta1` to `theta6` are the joint positions in rad, `S1`, `C1` and so on their sines and cosines, `S23`, `C23` of
    the sum of the second and third.

    Args:
        count: How many configurations.
        generator: Source of the draw.
    """
    q = generator.uniform(-np.pi, np.pi, (count, JOINTS))
    values = {f"theta{i + 1}": q[:, i] for i in range(JOINTS)}
    values |= {f"S{i + 1}": np.sin(q[:, i]) for i in range(JOINTS)}
    values |= {f"C{i + 1}": np.cos(q[:, i]) for i in range(JOINTS)}
    return values | {"S23": np.sin(q[:, 1] + q[:, 2]), "C23": np.cos(q[:, 1] + q[:, 2])}


def positions(values: Symbols) -> FloatArray:
    """Return the joint positions of a sample, shape (T, 6), in rad."""
    return np.column_stack([values[f"theta{i + 1}"] for i in range(JOINTS)])


def row_transform(row: tuple[float, float, float, float], angle: FloatArray) -> FloatArray:
    """Return the transform of one row of a modified Denavit-Hartenberg table, shape (T, 4, 4), in mm."""
    alpha, a, offset, d = row
    return product([rotation("x", alpha), translation("x", a), rotation("z", angle + offset), translation("z", d)])


def frames(q: FloatArray) -> list[FloatArray]:
    """Return the transforms of frames 1 to 6 in the base frame by the mended table, shape (T, 4, 4) each, in mm."""
    result: list[FloatArray] = []
    for i, row in enumerate(TABLE):
        step = row_transform(row, q[:, i])
        result.append(result[-1] @ step if result else step)
    return result


def pose(q: FloatArray) -> FloatArray:
    """Return the transform of frame 6 in the base frame by the mended table, shape (T, 4, 4), in mm."""
    return frames(q)[-1]


@cache
def model() -> RobotModel:
    """Return the arm from the maker's joints as a Pinocchio model, its lengths in mm, its tip the report's frame 6."""
    to_axis = {"x": rotation("y", _HALF)[0], "y": rotation("x", -_HALF)[0], "z": np.eye(4)}
    turned = [np.eye(4), *(to_axis[axis] for axis in _AXES)]
    placements = [np.linalg.inv(turned[i]) @ placed(_ORIGINS[i], np.eye(4)) @ turned[i + 1] for i in range(JOINTS)]
    return chain_model([*placements, np.linalg.inv(turned[-1]) @ _FRAMES[-1]])


def _model_frames(q: FloatArray) -> FloatArray:
    """Return the report's frames 1 to 6 by Pinocchio, shape (T, 6, 4, 4), in mm."""
    names = tuple(f"link{i + 1}" for i in range(JOINTS))
    to_axis = {"x": rotation("y", _HALF)[0], "y": rotation("x", -_HALF)[0], "z": np.eye(4)}
    fixed = np.array([np.linalg.inv(to_axis[axis]) @ frame for axis, frame in zip(_AXES, _FRAMES, strict=True)])
    return np.asarray(np.array([model().frame_poses(row, names) for row in q]) @ fixed)


def model_poses(q: FloatArray) -> FloatArray:
    """Return the transforms of frame 6 by Pinocchio, shape (T, 4, 4), in mm."""
    return np.array([model().tip_pose(row) for row in q])


def model_jacobians(q: FloatArray) -> FloatArray:
    """Return the basic Jacobians by Pinocchio in the base frame, shape (T, 6, 6); linear rows first, in mm/rad."""
    return np.array([model().tip_jacobian(row) for row in q])


def in_frame_6(jacobians: FloatArray, poses: FloatArray) -> FloatArray:
    """Return Jacobians of the base frame seen from frame 6, shape (T, 6, 6)."""
    turned = poses[:, :3, :3].transpose(0, 2, 1)
    return np.concatenate([turned @ jacobians[:, :3], turned @ jacobians[:, 3:]], axis=1)


def named(matrices: FloatArray, letter: str) -> Elements:
    """Return the elements of matrices by the report's names, counted from 0, and the whole under its letter."""
    rows, columns = matrices.shape[1:]
    return {f"{letter}_{i}{j}": matrices[:, i, j] for i in range(rows) for j in range(columns)} | {letter: matrices}


def _steps_by_model(values: Symbols) -> Elements:
    each = _model_frames(positions(values))
    before = np.concatenate([np.broadcast_to(np.eye(4), (len(each), 1, 4, 4)), each[:, :-1]], axis=1)
    between = np.linalg.inv(before) @ each
    return {f"T_{i + 1}": between[:, i] for i in range(JOINTS)}


def _steps_by_table(values: Symbols) -> Elements:
    q = positions(values)
    return {f"T_{i + 1}": row_transform(row, q[:, i]) for i, row in enumerate(TABLE)}


def _row(place: int, mended: bool) -> Callable[[Symbols], Elements]:
    def step(values: Symbols) -> Elements:
        alpha, a, offset, d = TABLE[place]
        row = (alpha, a, offset if mended else 0.0, d)
        return {f"T_{place + 1}": row_transform(row, positions(values)[:, place])}

    return step


printed_row_1, printed_row_2, printed_row_3, printed_row_4, printed_row_5, printed_row_6 = (
    _row(place, mended=False) for place in range(JOINTS)
)
mended_row_2, mended_row_6 = _row(1, mended=True), _row(5, mended=True)

steps = Truth(_steps_by_model, _steps_by_table, ("Pinocchio, the maker's joints", "the mended table"))
transform = Truth(
    lambda values: named(model_poses(positions(values)), "T"),
    lambda values: named(pose(positions(values)), "T"),
    ("Pinocchio, the maker's joints", "product of the mended table"),
)
jacobian = Truth(
    lambda values: named(model_jacobians(positions(values)), "J_g0"),
    lambda values: named(jacobian_by_differences(pose, positions(values)), "J_g0"),
    ("Pinocchio, the maker's joints", "differences of the mended table's product"),
)
jacobian_6 = Truth(
    lambda values: named(in_frame_6(model_jacobians(positions(values)), model_poses(positions(values))), "J_g6"),
    lambda values: named(in_frame_6(jacobian_by_differences(pose, positions(values)), pose(positions(values))), "J_g6"),
    ("Pinocchio, the maker's joints, turned into frame 6", "differences of the mended table's product, turned"),
)


def chained_as_printed(values: Symbols) -> Elements:
    """Return the product with 5 over 5 for its last factor: frame 5 in itself, which is the identity."""
    each = _steps_by_model(values)
    return {"T": product([each[f"T_{i + 1}"] for i in range(JOINTS - 1)])}


def chained(values: Symbols) -> Elements:
    """Return the product of the six transforms, each from the maker's joints."""
    each = _steps_by_model(values)
    return {"T": product([each[f"T_{i + 1}"] for i in range(JOINTS)])}
