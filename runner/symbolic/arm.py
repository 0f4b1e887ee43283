"""Constants of the rigid bodies of an arm, with every joint axis rotated to z."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from runner.base import portable
from runner.base.arrays import FloatArray
from runner.robots.drawn import DrawnModel
from runner.robots.model import RobotModel
from runner.symbolic.vectors import Matrix, Scalar, Vector, product, rotate_tensor, transpose

_ROUNDING = 1e-14  # a right angle's cosine is 6e-17
_FIXED = (0.0, 1.0, -1.0)  # numbers that are not parameters of code
_AXES = np.eye(3)
_Entry = tuple[Any, float | None]  # a number, and the constant that it is equal to


@dataclass(frozen=True)
class Folding:
    """Function from numbers to scalars with its own rule for numbers that may stay floats, such as 0, 1 and -1.

    Attributes:
        make: The function.
        fold: Function for a number that may stay a float.
    """

    make: Callable[[Any], Scalar]
    fold: Callable[[Any], Scalar]

    def __call__(self, value: Any) -> Scalar:
        """Return the scalar for a number that does not stay a float."""
        return self.make(value)


@dataclass(frozen=True)
class Body:
    """A moving link, in the frame of its joint, whose axis is z.

    Attributes:
        parent: Index of the parent body; None for the base.
        prismatic: True if the joint is prismatic, along z; False if it is revolute, about z.
        rotation: Rotation from the body's frame at joint position 0 to the parent's frame, shape (3, 3).
        position: Origin of the body's frame in the parent's frame at joint position 0, shape (3,), in m.
        mass: Mass, in kg.
        moment: Mass times the vector from the origin to the centre of mass, shape (3,), in kg m.
        inertia: Inertia about the origin, shape (3, 3), in kg m^2.
        armature: Reflected inertia of the joint's motor and gear, in kg m^2; in kg for a prismatic joint.
        turn: Rotation from the body's frame to the model's joint frame, in which its inertial parameters are given,
            shape (3, 3).
    """

    parent: int | None
    prismatic: bool
    rotation: Matrix
    position: Vector
    mass: Scalar
    moment: Vector
    inertia: Matrix
    armature: Scalar
    turn: Matrix


class ArmConstants(NamedTuple):
    """Constants for the kinematics and dynamics of an arm.

    Attributes:
        bodies: The moving links; a parent comes before its children.
        tip_body: Index of the body with the tip.
        tip_rotation: Rotation from the tip's frame to that body's frame, shape (3, 3).
        tip_position: Position of the tip in that body's frame, shape (3,), in m.
        gravity: Gravity vector in the base frame, shape (3,), in m/s^2.
    """

    bodies: tuple[Body, ...]
    tip_body: int
    tip_rotation: Matrix
    tip_position: Vector
    gravity: Vector


def constants_of(
    model: RobotModel, number: Callable[[float], Scalar] = float, gravity: Vector | None = None, tip: str | None = None
) -> ArmConstants:
    """Return an arm's constants.

    Links on fixed joints belong to their parent body, as merged by Pinocchio.

    Args:
        model: Model of the arm, which must not change later. Masses of a DrawnModel are arrays over its arms.
        number: Function that returns the scalar for a constant. It is not called for 0, 1 and -1, which stay floats,
            unless it is a Folding.
        gravity: Gravity vector in the base frame, shape (3,), in m/s^2, as scalars; None for the model's.
        tip: Name of the tip frame; None for the model's.
    """
    common = model.common if isinstance(model, DrawnModel) else model
    bodies, known = _raw_bodies(common), _raw_entries(common)
    if isinstance(model, DrawnModel):
        bodies = [_drawn(*own) for own in zip(bodies, model.rows.transpose(1, 2, 0), strict=True)]
        known = [_entries(body) for body in bodies]
    frame = model.tip_frame if tip is None else model.pin_model.getFrameId(tip)
    tip_body, rotation, position = _raw_tip(common, frame)
    return ArmConstants(
        tuple(_with_scalars(body, _scalars(entries, number)) for body, entries in zip(bodies, known, strict=True)),
        tip_body,
        _nested(rotation, number),
        _nested(position, number),
        _nested(_rounded(model.gravity), number) if gravity is None else gravity,
    )


def _entries(body: Body) -> list[_Entry]:
    """Return the numbers of a body in order, each with the constant 0, 1 or -1 that it is equal to, or None."""
    upper = [body.inertia[i][j] for i in range(3) for j in range(i, 3)]
    inertial = body.mass, *body.moment, *upper, body.armature
    values = *chain(*body.rotation), *body.position, *inertial, *chain(*body.turn)
    return [(value, constant_of(value)) for value in values]


def _scalars(entries: Sequence[_Entry], number: Callable[[float], Scalar]) -> list[Scalar]:
    if isinstance(number, Folding):
        return [number.fold(value) for value, _ in entries]
    return [number(value) if constant is None else constant for value, constant in entries]


def _with_scalars(body: Body, scalars: Sequence[Scalar]) -> Body:
    """Return a body with other numbers, in the order of `_entries`."""
    xx, xy, xz, yy, yz, zz = scalars[16:22]
    return Body(
        body.parent,
        body.prismatic,
        [scalars[0:3], scalars[3:6], scalars[6:9]],
        scalars[9:12],
        scalars[12],
        scalars[13:16],
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
        scalars[22],
        [scalars[23:26], scalars[26:29], scalars[29:32]],
    )


@lru_cache(maxsize=256)
def _raw_entries(model: RobotModel) -> Sequence[list[_Entry]]:
    return [_entries(body) for body in _raw_bodies(model)]


@lru_cache(maxsize=256)
def _raw_bodies(model: RobotModel) -> Sequence[Body]:
    """Return the bodies of an arm with float constants, each joint's axis rotated to z."""
    arm, turns = model.pin_model, _turns(model)
    bodies = []
    for index, (placement, inertia) in enumerate(
        zip(list(arm.jointPlacements)[1:], list(arm.inertias)[1:], strict=True)
    ):
        parent, turn = arm.parents[index + 1] - 1, turns[index]
        at_parent = turns[parent].T
        centre = turn.T @ inertia.lever
        about_origin = turn.T @ inertia.inertia @ turn + inertia.mass * (
            portable.dot(centre, centre) * _AXES - np.outer(centre, centre)
        )
        bodies.append(
            Body(
                parent if parent >= 0 else None,
                bool(model.prismatic[index]),
                _rounded(at_parent @ placement.rotation @ turn),
                _rounded(at_parent @ placement.translation),
                _rounded(inertia.mass),
                _rounded(inertia.mass * centre),
                _rounded(about_origin),
                float(arm.armature[index]),
                _rounded(turn),
            )
        )
    return tuple(bodies)


def _drawn(body: Body, parameters: FloatArray) -> Body:
    """Return a body with inertial parameters over runs, shape (10, runs); see Arm.regressor."""
    back = transpose(body.turn)
    mass, *moment = parameters[:4]
    xx, xy, yy, xz, yz, zz = parameters[4:]
    inertia = rotate_tensor(back, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return replace(
        body,
        mass=_near(mass),
        moment=[_near(np.asarray(part)) for part in product(back, moment)],
        inertia=[[_near(np.asarray(part)) for part in row] for row in inertia],
    )


@lru_cache(maxsize=256)
def _raw_tip(model: RobotModel, frame: int) -> tuple[int, Any, Any]:
    """Return the body with a frame, and the frame's rotation and origin in it."""
    end = model.pin_model.frames[frame]
    turn = _turns(model)[end.parentJoint - 1].T
    return end.parentJoint - 1, _rounded(turn @ end.placement.rotation), _rounded(turn @ end.placement.translation)


def _turns(model: RobotModel) -> list[FloatArray]:
    """Return the rotation of each joint's frame to an axis along z, and the identity for the base at the end."""
    return [*(_axis_to_z(joint) for joint in list(model.pin_model.joints)[1:]), _AXES]


def _axis_to_z(joint: Any) -> FloatArray:
    """Return a rotation from z to a joint's axis, shape (3, 3); a permutation of axes if the axis is x, y or z."""
    data = joint.createData()
    joint.calc(data, np.zeros(1))
    motion = np.asarray(data.S, dtype=np.float64).reshape(6)
    axis = motion[:3] if motion[:3].any() else motion[3:]
    for first in range(3):
        if axis[first] == 1.0:
            return np.column_stack([_AXES[(first + 1) % 3], _AXES[(first + 2) % 3], axis])
    across = portable.unit(np.cross(axis, _AXES[int(np.argmin(np.abs(axis)))]))
    return np.column_stack([across, np.cross(axis, across), axis])


def to_scalars(values: Any, number: Callable[[Any], Scalar]) -> Any:
    """Return numbers as nested scalars: 0, 1 and -1 as floats, others converted by `number`."""
    return _nested(_rounded(values), number)


def _nested(values: Any, number: Callable[[Any], Scalar]) -> Any:
    return [_nested(value, number) for value in values] if isinstance(values, list) else _scalar(values, number)


def to_scalar(value: Any, number: Callable[[Any], Scalar]) -> Scalar:
    """Return a number or an array over runs as a scalar, rounded; see to_scalars."""
    return _scalar(_near(value) if isinstance(value, np.ndarray) else _rounded(value), number)


def _scalar(value: Any, number: Callable[[Any], Scalar]) -> Scalar:
    if isinstance(number, Folding):
        return number.fold(value)
    constant = constant_of(value)
    return number(value) if constant is None else constant


def constant_of(value: Any) -> float | None:
    """Return 0, 1 or -1 if a number, or an array over runs, is equal to it; else None."""
    if not isinstance(value, np.ndarray):
        return float(value) if value in _FIXED else None
    first = float(value[0])
    return first if first in _FIXED and np.all(value == first) else None


def _rounded(values: Any) -> Any:
    """Return numbers as nested lists; values within rounding of 0, 1 or -1 are replaced by these."""
    if isinstance(values, float):  # the usual case, and as an array a slow one
        return next((fixed for fixed in _FIXED if abs(values - fixed) < _ROUNDING), float(values))
    return _near(np.asarray(values, dtype=np.float64)).tolist()


def _near(values: FloatArray) -> FloatArray:
    """Return numbers; those within rounding of 0, 1 or -1 are replaced by these."""
    if not values.any():  # the usual case, and the rest is slow
        return np.zeros(values.shape)
    nearest = np.clip(np.round(values), -1.0, 1.0)
    near = np.abs(values - nearest) < _ROUNDING
    return np.where(near, nearest + 0.0, values)
