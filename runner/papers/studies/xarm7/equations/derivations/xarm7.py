"""Reference derivations of the xArm7's transform, Jacobian and inverse kinematics, with the report's dimensions, in cm.

The first derivation is Pinocchio on a URDF with these dimensions; the second multiplies the elementary transforms that
the report gives.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import (
    Derivations,
    Elements,
    Symbols,
    columns,
    coordinates,
    product,
    rotation,
    translation,
    whole_and_elements,
)
from runner.papers.audit.model_derivations import audited_arm, by_model, sample

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
    """Return the report's lengths in cm and angles in rad, the same at each of this many configurations."""
    values = {"l1": L1, "l2": L2, "l3": L3, "l4": L4, "l5": L5, "theta1": THETA1, "theta2": THETA2}
    return {name: np.full(count, value) for name, value in values.items()}


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random configurations with the report's measures.

    `b_0` to `b_7` are the z axes of the frames of the report's chain and `r_0E` to `r_7E` the vectors from their
    origins to the tip, in cm. `J` is the Jacobian with linear rows in m/rad.
    """
    values = sample(ARM.model, ARM.joints, count, generator)
    found = frames(positions(values))
    axes = {f"b_{i}": frame[:, :3, 2] for i, frame in enumerate(found)}
    levers = {f"r_{i}E": found[-1][:, :3, 3] - frame[:, :3, 3] for i, frame in enumerate(found)}
    return {**values, **axes, **levers, **constants(count), "J": _metres(values), "pi": np.full(count, np.pi)}


def positions(values: Symbols) -> FloatArray:
    """Return the joint positions of a sample, shape (T, 7), in rad."""
    return columns(values, ARM.joints)


def pose(q: FloatArray) -> FloatArray:
    """Return the transform of frame 7 in the base frame by the report's chain, shape (T, 4, 4), in cm."""
    return frames(q)[-1]


def frames(q: FloatArray) -> list[FloatArray]:
    """Return the same of frames 0 to 7, shape (T, 4, 4) each."""
    found = [np.tile(np.eye(4), (len(q), 1, 1))]
    for place in range(JOINTS):
        found.append(product([found[-1], *steps(place, q[:, place])]))
    return found


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


def _by_chain(found: Callable[[FloatArray], Elements]) -> Derivations:
    """Return derivations of what follows from the transforms of frame 7."""
    return Derivations(
        lambda values: found(BY_MODEL.pose(positions(values))),
        lambda values: found(pose(positions(values))),
        ("Pinocchio", "product of the elementary transforms"),
    )


transform = _by_chain(lambda poses: whole_and_elements("A", poses))
tip = _by_chain(lambda poses: coordinates("P_e", poses[:, :3, 3], ""))


# The manufacturer's links, which the report's transforms connect.

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


link = Derivations(_by_model, _by_origins, ("Pinocchio, robots/xarm7.urdf", "the maker's joint origins"))


# Jacobian and pseudo-inverse.


def printed_jacobians(q: FloatArray) -> FloatArray:
    """Return the Jacobians with axis and origin of frame i - 1 in column i, (T, 7) to (T, 6, 7), in cm/rad and 1."""
    found = frames(q)
    axes = [frame[:, :3, 2] for frame in found[:JOINTS]]
    levers = [found[-1][:, :3, 3] - frame[:, :3, 3] for frame in found]
    return np.stack([np.hstack([np.cross(b, r), b]) for b, r in zip(axes, levers, strict=False)], axis=2)


def _metres(values: Symbols) -> FloatArray:
    """Return the Jacobians by Pinocchio with linear rows in m/rad, so that both kinds of rows are of one size."""
    return np.asarray(BY_MODEL.jacobian(positions(values)) / np.array([100.0, 100.0, 100.0, 1.0, 1.0, 1.0])[:, None])


def left_inverse_of(q: FloatArray) -> FloatArray:
    """Return (J' J)^-1 J' in floating point, shapes (7,) to (7, 6): rounding, or NaN at an exact zero."""
    J = BY_MODEL.jacobian(q[None])[0]
    try:
        inverse: FloatArray = np.linalg.inv(J.T @ J) @ J.T
    except np.linalg.LinAlgError:
        return np.full(J.T.shape, np.nan)
    return inverse


def _by_factors(values: Symbols) -> Elements:
    Q, R = np.linalg.qr(_metres(values).transpose(0, 2, 1))
    return {"J_plus": np.asarray(Q @ np.linalg.inv(R).transpose(0, 2, 1), dtype=float)}


pseudo_inverse = Derivations(
    lambda values: {"J_plus": np.asarray(np.linalg.pinv(_metres(values)), dtype=float)},
    _by_factors,
    ("singular values", "least length by orthogonal factors"),
)
