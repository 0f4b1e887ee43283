"""Truths of the xArm7's transform, Jacobian and inverse kinematics, with the report's dimensions. Lengths in cm.

The first way is Pinocchio on a URDF with these dimensions; the second multiplies the elementary transforms that the
report gives.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from runner.audit.model_truths import audited_arm, by_model
from runner.audit.truth import (
    Elements,
    Symbols,
    Truth,
    Way,
    columns,
    coordinates,
    product,
    rotation,
    translation,
    whole_and_elements,
)
from runner.base.arrays import FloatArray

L1, L2, L3, L4, L5 = 26.7, 29.3, 5.25, 35.12, 12.32  # cm
THETA1, THETA2 = 0.2225, 0.6646  # rad
JOINTS = 7
_HALF = np.pi / 2
_FOLDER = Path(__file__).parents[2]

ARM = audited_arm("report.urdf", "", (), _FOLDER)
"""The arm of the report's measures, its lengths in cm."""

BY_MODEL = by_model(ARM.model)
"""Its kinematics by Pinocchio."""


def constants(count: int) -> dict[str, FloatArray]:
    """Return the report's lengths in cm and angles in rad, the same at each of so many configurations."""
    values = {"l1": L1, "l2": L2, "l3": L3, "l4": L4, "l5": L5, "theta1": THETA1, "theta2": THETA2}
    return {name: np.full(count, value) for name, value in values.items()}


def positions(values: Symbols) -> FloatArray:
    """Return the joint positions of a sample, shape (T, 7), in rad."""
    return columns(values, ARM.joints)


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


def _by_chain(found: Callable[[FloatArray], Elements]) -> Truth:
    """Return the truth of what follows from the transforms of frame 7."""
    return Truth(
        lambda values: found(BY_MODEL.pose(positions(values))),
        lambda values: found(pose(positions(values))),
        ("Pinocchio", "product of the elementary transforms"),
    )


transform = _by_chain(lambda poses: whole_and_elements("A", poses))
tip = _by_chain(lambda poses: coordinates("P_e", poses[:, :3, 3], ""))


# The maker's links, between which the report's transforms stand.

_ORIGINS = (  # of each joint in the link before it, in cm, and its roll in quarter turns: the maker's numbers
    ((0, 0, 26.7), 0),
    ((0, 0, 0), -1),
    ((0, -29.3, 0), 1),
    ((5.25, 0, 0), 1),
    ((7.75, -34.25, 0), 1),
    ((0, 0, 0), 1),
    ((7.6, 9.7, 0), -1),
)


def _by_model(values: Symbols) -> Elements:
    names = ("link_base", *(f"link{i + 1}" for i in range(JOINTS)))
    model = audited_arm("xarm7.urdf", "", (), _FOLDER).model
    frames = np.array([model.frame_poses(q, names) for q in positions(values)])
    frames[..., :3, 3] *= 100
    return {f"A_{i + 1}": np.linalg.inv(frames[:, i]) @ frames[:, i + 1] for i in range(JOINTS)}


def _by_origins(values: Symbols) -> Elements:
    found = {}
    for i, ((origin, quarters), angle) in enumerate(zip(_ORIGINS, positions(values).T, strict=True), start=1):
        shifts = [translation(axis, length) for axis, length in zip("xyz", origin, strict=True)]
        found[f"A_{i}"] = product([*shifts, rotation("x", quarters * _HALF), rotation("z", angle)])
    return found


link = Truth(_by_model, _by_origins, ("Pinocchio, robots/xarm7.urdf", "the maker's joint origins"))


def _step(place: int) -> Way:
    return lambda values: {f"A_{place + 1}": product(steps(place, positions(values)[:, place]))}


step_1, step_2, step_3, step_4, step_5, step_6, step_7 = (_step(place) for place in range(JOINTS))


# Jacobian and pseudo-inverse.


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
    return np.asarray(BY_MODEL.jacobian(positions(values)) / np.array([100.0, 100.0, 100.0, 1.0, 1.0, 1.0])[:, None])


def left_inverse(values: Symbols) -> Elements:
    """Return (J' J)^-1 J', computed as it is printed; J' J is 7 by 7 and of rank 6."""
    return {"J^+": np.array([_left_inverse(J) for J in _metres(values)])}


def left_inverse_of(q: FloatArray) -> FloatArray:
    """Return the same at one configuration, shapes (7,) to (7, 6), for twists in cm/s and rad/s."""
    return _left_inverse(BY_MODEL.jacobian(q[None])[0])


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
