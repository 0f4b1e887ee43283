"""Config of the robot: one arm, or several arms mounted on each other."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, NonNegativeFloat, PositiveFloat, field_validator

from runner.schema.model import StrictModel
from runner.schema.per_joint import FrictionConfig
from runner.schema.per_stage import NonNegativePerStage, PositivePerStage, TorquePerStage
from runner.schema.units import (
    JointInertia,
    JointPosition,
    JointSpeed,
    JointTorque,
    Kilograms,
    Metres,
    MomentOfInertia,
    Radians,
    RadiansPerSecond,
    Seconds,
)

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
_LONGEST_NAME = 200
Name = Annotated[str, Field(min_length=1, max_length=_LONGEST_NAME)]
FileName = Annotated[str, Field(min_length=1)]


def _armature(value: Any) -> float | list[float] | str:
    numbers = value if isinstance(value, list) else [value]
    if isinstance(value, str) and 0 < len(value) <= _LONGEST_NAME and value[0].isalpha():
        return value
    if all(isinstance(n, int | float) and not isinstance(n, bool) and 0.0 <= n < math.inf for n in numbers):
        return [float(n) for n in numbers] if isinstance(value, list) else float(value)
    raise ValueError("must be a number of 0 or more, a list of such with one for each joint, or the name of a set")


Armature = Annotated[float | list[float] | str, BeforeValidator(_armature)]


class ArmConfig(StrictModel):
    """One arm.

    Attributes:
        urdf: Its URDF: a file among ours, in a config folder of the user's, or an absolute path; None where it has an
            MJCF.
        mjcf: Its MJCF, MuJoCo's format, found likewise; None where it has a URDF.
        tip: Name of its tip frame.
        home: Joint positions at home, in rad; m where a joint slides.
        inertials: Set of masses, centres of mass and inertias, of those in `<urdf>.inertials.yaml`, in place of the
            file's; None keeps these.
        masses: Mass of links by name, in kg, in place of the file's or the set's.
        armature: Reflected inertia of motor and gear, N^2 J, in kg m^2; kg where a joint slides. It adds to the
            diagonal of the mass matrix and to nothing else. One for all joints, a list with one for each, or the name
            of a set of those in `<urdf>.armature.yaml`.
        velocity_limits: Largest speed of joints by name, in rad/s; m/s where a joint slides. They stand in place of the
            file's; an MJCF has none.
    """

    urdf: FileName | None
    mjcf: FileName | None
    tip: Name
    home: JointPosition[list[float]]
    inertials: Name | None
    masses: Kilograms[dict[str, PositiveFloat]]
    armature: JointInertia[Armature]
    velocity_limits: JointSpeed[dict[str, PositiveFloat]]


class MountConfig(StrictModel):
    """Where an arm is mounted on the one below.

    Attributes:
        frame: Link of the arm below (by its own name there) on which the root link is fixed.
        translation: Origin of the root in that link's frame, in m.
        rotation: Roll, pitch, yaw of the root in that link's frame, in rad.
    """

    frame: Name
    translation: Metres[Vector]
    rotation: Radians[Vector]


class StageConfig(ArmConfig):
    """One arm of several, from the base outwards.

    Attributes:
        mount: Where it is mounted; None for the first stage alone.
    """

    mount: MountConfig | None


class PayloadChange(StrictModel):
    """Another payload from some time on.

    Attributes:
        at: Time of the change, in s: the first tick then or later.
        mass: The payload's mass from then on, in kg.
    """

    at: Seconds[PositiveFloat]
    mass: Kilograms[NonNegativeFloat]


class PayloadConfig(StrictModel):
    """A point mass fixed at the tip, which both the plant and the controllers' model hold.

    Attributes:
        mass: Its mass, in kg.
        position: Its place in the tip frame, in m.
        schedule: Changes of the true arm's payload on the way, as `{at: 1.5, mass: 2.0}`, in s and kg, one after
            another; the controllers go on to believe `mass`.
    """

    mass: Kilograms[NonNegativeFloat]
    position: Metres[Vector]
    schedule: list[PayloadChange] = Field(default_factory=list)

    @field_validator("schedule")
    @classmethod
    def _check_schedule(cls, value: list[PayloadChange]) -> list[PayloadChange]:
        for before, change in pairwise(value):
            if change.at <= before.at:
                raise ValueError(f"must run forward in time; {change.at:g} s comes after {before.at:g} s")
        return value

    @property
    def largest(self) -> float:
        """The largest mass of all times, in kg."""
        return max([self.mass, *(change.mass for change in self.schedule)])


class ToolConfig(StrictModel):
    """A rigid tool on the flange, which both the plant and the controllers' model hold; its tip is what is controlled.

    Attributes:
        mass: In kg.
        centre_of_mass: In the flange's frame, in m.
        inertia: Principal moments about the centre of mass, along the flange's axes, in kg m^2.
        tip: Its tip, the tool centre point, in the flange's frame, in m.
        tip_radius: Radius of the ball at its tip that touches walls, in m.
    """

    mass: Kilograms[PositiveFloat]
    centre_of_mass: Metres[Vector]
    inertia: MomentOfInertia[Annotated[list[PositiveFloat], Field(min_length=3, max_length=3)]]
    tip: Metres[Vector]
    tip_radius: Metres[PositiveFloat]


class RobotConfig(StrictModel):
    """A robot of one arm or of several, by the values of its sources; other groups take them as `${robot.x}`.

    Attributes:
        name: Its name.
        start: Tip position where trajectories start, in m; None is the tip at home.
        goal: Tip position that goal, quintic and line go to, in m.
        path_size: Size of the paths that have one, such as a circle's radius, in m.
        tool: What is fixed on its tip frame, whose own tip is controlled then; None for nothing.
        friction: Friction in its joints, which plants that take torques have; over all stages where there are several.
        payload: What its tip carries.
        rated_payload: The largest payload that its maker allows, in kg; None where none is stated.
        natural_frequency: omega_n of its controller, in rad/s, by stage where it has several; so all that follow.
        damping_ratio: xi of its controller.
        period: Its controller's period, in s.
        joint_error_limit: Error of its joint positions, in rad; m where a joint slides.
        no_joint_error: Zero for each stage, which `noise: none` takes.
        torque_limit: Its largest continuous torque, in N m; N where a joint slides. None where none is stated beside
            the URDF's efforts.
        settling_band: Tip error within which it counts as settled, on each axis, in m.
    """

    name: Name
    start: Metres[Vector | None]
    goal: Metres[Vector]
    path_size: Metres[PositiveFloat]
    tool: ToolConfig | None
    friction: FrictionConfig
    payload: PayloadConfig
    rated_payload: Kilograms[PositiveFloat | None]
    natural_frequency: RadiansPerSecond[PositivePerStage]
    damping_ratio: PositivePerStage
    period: Seconds[PositivePerStage]
    joint_error_limit: JointPosition[NonNegativePerStage]
    no_joint_error: NonNegativePerStage
    torque_limit: JointTorque[TorquePerStage | None]
    settling_band: Metres[PositiveFloat]

    @property
    def arms(self) -> Mapping[str, ArmConfig]:
        """Its arms by name, from the base outwards."""
        raise NotImplementedError

    @property
    def burden(self) -> float:
        """Largest mass of what its tip carries, tool and payload, in kg."""
        return self.payload.largest + (0.0 if self.tool is None else self.tool.mass)

    @property
    def warnings(self) -> list[str]:
        """What is unusual in these values though a calibration goes on; a run has a caveat in their place."""
        tool = 0.0 if self.tool is None else self.tool.mass
        if self.rated_payload is None or self.burden <= self.rated_payload:
            return []
        borne = (
            f"robot.payload.mass: {self.payload.largest:g} kg is"
            if self.tool is None
            else (f"robot.tool.mass and robot.payload.mass: {tool:g} and {self.payload.largest:g} kg are")
        )
        return [
            f"{borne} more than the {self.rated_payload:g} kg that {self.name} is rated for; the run goes on and shows "
            "where effort limits bite"
        ]


class OneArmConfig(RobotConfig, ArmConfig):
    """A robot that is one arm."""

    @property
    def arms(self) -> dict[str, ArmConfig]:
        """Its one stage, named after it."""
        return {self.name: self}


class StagedRobotConfig(RobotConfig):
    """A robot of arms riding on each other.

    Attributes:
        stages: The arms by name, from the base outwards.
    """

    stages: Annotated[dict[str, StageConfig], Field(min_length=2)]

    @property
    def arms(self) -> dict[str, StageConfig]:
        """Its stages."""
        return self.stages
