"""The xArm7 by the report's own measures: transform, Jacobian and inverse kinematics. Lengths in cm, as it has them.

The first way is Pinocchio on a URDF of these measures; the second multiplies the elementary transforms that the
report gives and takes differences.
"""

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

L1, L2, L3, L4, L5 = 26.7, 29.3, 5.25, 35.12, 12.32  # cm
THETA1, THETA2 = 0.2225, 0.6646  # rad
JOINTS = 7
_HALF = np.pi / 2


def symbols(count: int, generator: np.random.Generator) -> dict[str, FloatArray]:
    """Return what the report's names stand for at random configurations, each joint drawn from a full turn.

    Args:
        count: How many configurations.
        generator: Source of the draw.
    """
    q = generator.uniform(-np.pi, np.pi, (count, JOINTS))
    values = {f"q{i + 1}": q[:, i] for i in range(JOINTS)}
    values |= {f"s{i + 1}": np.sin(q[:, i]) for i in range(JOINTS)}
    values |= {f"c{i + 1}": np.cos(q[:, i]) for i in range(JOINTS)}
    return values | constants(count)


def constants(count: int) -> dict[str, FloatArray]:
    """Return the report's lengths in cm and angles in rad, the same at each of so many configurations."""
    values = {"l1": L1, "l2": L2, "l3": L3, "l4": L4, "l5": L5, "theta1": THETA1, "theta2": THETA2}
    return {name: np.full(count, value) for name, value in values.items()}


def positions(values: Symbols) -> FloatArray:
    """Return the joint positions of a sample, shape (T, 7), in rad."""
    return np.column_stack([values[f"q{i + 1}"] for i in range(JOINTS)])


def pose(q: FloatArray) -> FloatArray:
    """Return the transform of frame 7 in the base frame by the report's chain, shape (T, 4, 4), in cm."""
    return product([step for place in range(JOINTS) for step in steps(place, q[:, place])])


def steps(place: int, angle: FloatArray | float) -> list[FloatArray]:
    """Return the elementary transforms of one joint, as the assignment gives them, in cm."""
    turn = rotation("z", angle)
    chains = (
        [turn, translation("z", L1)],
        [rotation("x", -_HALF), turn],
        [rotation("x", _HALF), turn, translation("z", L2)],
        [rotation("x", _HALF), translation("x", L3), turn],
        [rotation("x", _HALF), translation("x", L4 * np.sin(THETA1)), turn, translation("z", L4 * np.cos(THETA1))],
        [rotation("x", _HALF), turn],
        [rotation("x", -_HALF), translation("x", L5 * np.sin(THETA2)), turn, translation("z", L5 * np.cos(THETA2))],
    )
    return chains[place]


@cache
def model() -> RobotModel:
    """Return the arm with the report's measures as a Pinocchio model, its lengths in cm."""
    rolls = (0, -_HALF, _HALF, _HALF, _HALF, _HALF, -_HALF, 0)
    before = (  # where each joint stands in the frame before it: that joint's last translation, then its own first
        (0, 0, 0),
        (0, 0, L1),
        (0, 0, 0),
        (L3, 0, L2),
        (L4 * np.sin(THETA1), 0, 0),
        (0, 0, L4 * np.cos(THETA1)),
        (L5 * np.sin(THETA2), 0, 0),
        (0, 0, L5 * np.cos(THETA2)),
    )
    return chain_model([placed(place, rotation("x", roll)[0]) for place, roll in zip(before, rolls, strict=True)])


def model_poses(q: FloatArray) -> FloatArray:
    """Return the transforms of frame 7 by Pinocchio, shape (T, 4, 4), in cm."""
    return np.array([model().tip_pose(row) for row in q])


def model_jacobians(q: FloatArray) -> FloatArray:
    """Return the basic Jacobians by Pinocchio, shape (T, 6, 7); linear rows first, in cm/rad."""
    return np.array([model().tip_jacobian(row) for row in q])


def _named(matrices: FloatArray, letter: str) -> Elements:
    rows, columns = matrices.shape[1:]
    elements = {f"{letter}_{i + 1}{j + 1}": matrices[:, i, j] for i in range(rows) for j in range(columns)}
    return elements | {letter: matrices}


def _tip(poses: FloatArray) -> Elements:
    return {f"P_e{axis}": poses[:, i, 3] for i, axis in enumerate("xyz")}


transform = Truth(
    lambda values: _named(model_poses(positions(values)), "A"),
    lambda values: _named(pose(positions(values)), "A"),
    ("Pinocchio", "product of the elementary transforms"),
)
tip = Truth(
    lambda values: _tip(model_poses(positions(values))),
    lambda values: _tip(pose(positions(values))),
    ("Pinocchio", "product of the elementary transforms"),
)
jacobian = Truth(
    lambda values: _named(model_jacobians(positions(values)), "J"),
    lambda values: _named(jacobian_by_differences(pose, positions(values)), "J"),
    ("Pinocchio", "differences of the chain of transforms"),
)


def printed_column(values: Symbols) -> Elements:
    """Return the Jacobian with the axis and origin of frame i - 1 of the report's chain in column i."""
    return {"J": printed_jacobians(positions(values))}


def printed_jacobians(q: FloatArray) -> FloatArray:
    """Return the same for rows of joint positions, shapes (T, 7) to (T, 6, 7), linear rows in cm/rad."""
    return _columns(q, first=0)


def right_column(values: Symbols) -> Elements:
    """Return the Jacobian with the axis and origin of frame i in column i: the joint turns about its own z axis."""
    return {"J": _columns(positions(values), first=1)}


def _columns(q: FloatArray, first: int) -> FloatArray:
    frames = [np.tile(np.eye(4), (len(q), 1, 1))]
    for place in range(JOINTS):
        frames.append(product([frames[-1], *steps(place, q[:, place])]))
    tip_position = frames[-1][:, :3, 3]
    return np.stack(
        [
            np.hstack([np.cross(frame[:, :3, 2], tip_position - frame[:, :3, 3]), frame[:, :3, 2]])
            for frame in frames[first : first + JOINTS]
        ],
        axis=2,
    )


def _metres(values: Symbols) -> FloatArray:
    """Return the Jacobians by Pinocchio with linear rows in m/rad, so that both kinds of rows are of one size."""
    return np.asarray(model_jacobians(positions(values)) / np.array([100.0, 100.0, 100.0, 1.0, 1.0, 1.0])[:, None])


def left_inverse(values: Symbols) -> Elements:
    """Return (J' J)^-1 J', computed as it is printed; J' J is 7 by 7 and of rank 6."""
    return {"J^+": np.array([_left_inverse(J) for J in _metres(values)])}


def left_inverse_of(q: FloatArray) -> FloatArray:
    """Return the same at one configuration, shapes (7,) to (7, 6), for twists in cm/s and rad/s."""
    return _left_inverse(model_jacobians(q[None])[0])


def _left_inverse(J: FloatArray) -> FloatArray:
    """Return what a computer makes of (J' J)^-1 J': rounding, or nothing where it meets an exact zero."""
    try:
        inverse: FloatArray = np.linalg.inv(J.T @ J) @ J.T
    except np.linalg.LinAlgError:
        return np.full(J.T.shape, np.nan)
    return inverse


def right_inverse(values: Symbols) -> Elements:
    """Return J' (J J')^-1."""
    J = _metres(values)
    transposed = J.transpose(0, 2, 1)
    return {"J^+": np.asarray(np.linalg.solve(J @ transposed, J).transpose(0, 2, 1), dtype=float)}


def _by_factors(values: Symbols) -> Elements:
    Q, R = np.linalg.qr(_metres(values).transpose(0, 2, 1))
    return {"J^+": np.asarray(Q @ np.linalg.inv(R).transpose(0, 2, 1), dtype=float)}


pseudo_inverse = Truth(
    lambda values: {"J^+": np.asarray(np.linalg.pinv(_metres(values)), dtype=float)},
    _by_factors,
    ("singular values", "least length by orthogonal factors"),
)
