"""Config of joint friction, mounts and tools, and config values per joint of a stage and per stage of a robot."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BeforeValidator, Field, NonNegativeFloat, PositiveFloat

from runner.base.errors import ConfigError, nearest, unknown
from runner.base.sanitize import quoted
from runner.schema.model import StrictModel
from runner.schema.units import (
    JointDamping,
    JointSpeed,
    JointSteepness,
    JointTorque,
    Kilograms,
    Metres,
    MomentOfInertia,
    Radians,
)

T = TypeVar("T")

LONGEST_NAME = 200
"""Largest length of a name, in characters."""
Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME)]
Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
PositivePerJoint = PositiveFloat | list[PositiveFloat]
NonNegativePerJoint = NonNegativeFloat | list[NonNegativeFloat]


class MountConfig(StrictModel):
    """Mount of an arm on the arm below.

    Attributes:
        frame: Link of the arm below on which the root link is fixed, by its name in that arm.
        translation: Origin of the root in that link's frame, in m.
        rotation: Roll, pitch, yaw of the root in that link's frame, in rad.
    """

    frame: Name
    translation: Metres[Vector]
    rotation: Radians[Vector]


class ToolConfig(StrictModel):
    """A rigid tool on the flange, which both the plant and the controllers' model contain; its tip is controlled.

    Attributes:
        mass: Mass of the tool, in kg.
        centre_of_mass: Centre of mass in the flange frame, in m.
        inertia: Principal moments about the centre of mass, along the axes of the flange frame, in kg m^2.
        tip: Tip of the tool (tool centre point) in the flange frame, in m.
        tip_radius: Radius of the ball at the tip that touches walls, in m.
    """

    mass: Kilograms[PositiveFloat]
    centre_of_mass: Metres[Vector]
    inertia: MomentOfInertia[Annotated[list[PositiveFloat], Field(min_length=3, max_length=3)]]
    tip: Metres[Vector]
    tip_radius: Metres[PositiveFloat]


def expand(key: str, value: float | list[float] | Mapping[str, float], joints: Sequence[str]) -> list[float]:
    """Return one value for each joint; 0 for a joint that a mapping does not name.

    Raises:
        ConfigError: if the length of a list differs from the number of joints, or a mapping names an unknown joint;
            names the joints.
    """
    if isinstance(value, Mapping):
        problems = [unknown("joint", name, joints, key) for name in value if name not in joints]
        if problems:
            raise ConfigError(problems)
        return [value.get(name, 0.0) for name in joints]
    if not isinstance(value, list):
        return [value] * len(joints)
    if len(value) != len(joints):
        raise ConfigError(
            f"{key}: {len(value)} values for {len(joints)} joints ({', '.join(joints)}); found {quoted(value)}"
        )
    return value


def _finite(value: Any) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise ValueError("must be a number")
    if not math.isfinite(value):
        raise ValueError("must be a finite number")
    return float(value)


def _number(value: Any, zero_allowed: bool) -> float:
    number = _finite(value)
    if number < 0.0 or (number == 0.0 and not zero_allowed):
        raise ValueError("must be 0 or more" if zero_allowed else "must be above 0")
    return number


def _of_part(part: object, check: Callable[[Any], Any], value: Any) -> Any:
    try:
        return check(value)
    except ValueError as error:
        raise ValueError(f"{part} {error}") from None


def _per_stage(check: Any) -> BeforeValidator:
    def parse(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {str(stage): _of_part(stage, check, item) for stage, item in value.items()}
        return check(value)

    return BeforeValidator(parse)


def _torque(value: Any) -> float | list[float]:
    try:
        if isinstance(value, list):
            return [_number(item, zero_allowed=False) for item in value]
        return _number(value, zero_allowed=False)
    except ValueError:
        raise ValueError("must be a number above 0, or a list of such numbers with one for each joint") from None


def _optional(null: str) -> BeforeValidator:
    def check(value: Any) -> float | list[float | None] | None:
        try:
            if isinstance(value, list):
                return [None if item is None else _number(item, zero_allowed=False) for item in value]
            return None if value is None else _number(value, zero_allowed=False)
        except ValueError:
            raise ValueError(
                f"must be a number above 0, null for {null}, or a list of these with one for each joint"
            ) from None

    return _per_stage(check)


FinitePerStage = Annotated[float | dict[str, float], _per_stage(_finite)]
PositivePerStage = Annotated[float | dict[str, float], _per_stage(lambda value: _number(value, zero_allowed=False))]
NonNegativePerStage = Annotated[float | dict[str, float], _per_stage(lambda value: _number(value, zero_allowed=True))]
TorquePerStage = Annotated[float | list[float] | dict[str, float | list[float]], _per_stage(_torque)]
OptionalPerStage = float | list[float | None] | dict[str, float | list[float | None] | None] | None
SpringPerStage = Annotated[OptionalPerStage, _optional("rigid joints")]
MotorPerStage = Annotated[OptionalPerStage, _optional("a joint whose motor has none")]
SpeedPerStage = Annotated[OptionalPerStage, _optional("a limit that is the same at every speed")]
NotchPerStage = Annotated[OptionalPerStage, _optional("joints without a notch")]


def _by_joint(check: Callable[[Any], Any]) -> BeforeValidator:
    def parse(value: Any) -> Any:
        if isinstance(value, list):
            return [_of_part(f"value {number}", check, item) for number, item in enumerate(value, start=1)]
        return check(value)

    return _per_stage(parse)


FiniteByJoint = Annotated[float | list[float] | dict[str, float], _by_joint(_finite)]
NonNegativeByJoint = Annotated[
    float | list[float] | dict[str, float], _by_joint(lambda value: _number(value, zero_allowed=True))
]
OptionalFiniteByJoint = Annotated[
    float | list[float] | dict[str, float] | None, _by_joint(lambda value: None if value is None else _finite(value))
]
OptionalNonNegativeByJoint = Annotated[
    float | list[float] | dict[str, float] | None,
    _by_joint(lambda value: None if value is None else _number(value, zero_allowed=True)),
]
OptionalPositiveByJoint = Annotated[
    float | list[float] | dict[str, float] | None,
    _by_joint(lambda value: None if value is None else _number(value, zero_allowed=False)),
]


class SigmoidConfig(StrictModel):
    """Config of smooth friction, which is zero at rest; values as in FrictionConfig.

    Attributes:
        level: Torque from one end of the curve to the other, in N m; N for prismatic joints.
        steepness: Steepness of the curve, in s/rad; s/m for prismatic joints.
        shift: Speed by which the curve is shifted, in rad/s; m/s for prismatic joints.
    """

    level: JointTorque[NonNegativeByJoint]
    steepness: JointSteepness[NonNegativeByJoint]
    shift: JointSpeed[FiniteByJoint]


class FrictionConfig(StrictModel):
    """Config of joint friction: one value for all joints, a list with one for each, or values by the joint's name.

    Attributes:
        viscous: Torque per speed, in N m s/rad; N s/m for prismatic joints.
        coulomb: Torque against any motion, in N m; N for prismatic joints. Joints at rest move only above it.
        asymmetry: Torque that is added to coulomb and static upwards and subtracted downwards, in N m; N for prismatic
            joints. None for 0.
        static: Torque above which joints at rest move, in N m; N for prismatic joints. None for coulomb.
        stribeck_speed: Speed over which friction falls from static to coulomb, in rad/s; m/s for prismatic joints. None
            if it falls as soon as a joint moves.
        stribeck_curve: Shape of this fall: an exponential or a Gauss curve.
        sigmoid: Smooth friction.
    """

    viscous: JointDamping[NonNegativeByJoint]
    coulomb: JointTorque[NonNegativeByJoint]
    asymmetry: JointTorque[OptionalFiniteByJoint]
    static: JointTorque[OptionalNonNegativeByJoint]
    stribeck_speed: JointSpeed[OptionalPositiveByJoint]
    stribeck_curve: Literal["exponential", "gauss"]
    sigmoid: SigmoidConfig


def by_stage(key: str, value: T | Mapping[str, T], stages: Sequence[str]) -> list[T]:
    """Return one value for each stage, in their order.

    Raises:
        ConfigError: for one value if the robot has several stages, for a mapping if it has one, and for missing or
            unknown stages; names the stages.
    """
    names = ", ".join(stages)
    if not isinstance(value, Mapping):
        if len(stages) > 1:
            raise ConfigError(f"{key}: needs a value for each stage ({names}); found {quoted(value)} for all")
        return [value]
    if len(stages) == 1:
        raise ConfigError(
            f"{key}: the robot has one stage ({names}) and takes one value; found {quoted(dict(value))} by stage"
        )
    return by_name(key, value, stages, "stage")


def by_name(key: str, value: Mapping[str, T], names: Sequence[str], what: str) -> list[T]:
    """Return the value of each name, in their order; `what` is what has the names, such as stage.

    Raises:
        ConfigError: for missing or unknown names.
    """
    known = f"{what}s: {', '.join(names)}"
    problems = [f"{key}.{name}: no such {what}{nearest(name, names)}; {known}" for name in value if name not in names]
    problems += [f"{key}.{name}: missing; {known}" for name in names if name not in value]
    if problems:
        raise ConfigError(problems)
    return [value[name] for name in names]
