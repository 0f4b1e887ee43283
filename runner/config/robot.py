"""Config of the robot: one arm, or several arms mounted on each other."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, NonNegativeFloat, PositiveFloat, field_validator

from runner.schema.model import StrictModel
from runner.schema.units import (
    JointInertia,
    JointPosition,
    JointSpeed,
    JointTorque,
    Kilograms,
    Metres,
    RadiansPerSecond,
    Seconds,
)
from runner.schema.values import (
    LONGEST_NAME,
    FrictionConfig,
    MountConfig,
    Name,
    NonNegativePerStage,
    PositivePerStage,
    ToolConfig,
    TorquePerStage,
    Vector,
)

FileName = Annotated[str, Field(min_length=1)]


def _armature(value: Any) -> float | list[float] | str:
    numbers = value if isinstance(value, list) else [value]
    if isinstance(value, str) and 0 < len(value) <= LONGEST_NAME and value[0].isalpha():
        return value
    if all(isinstance(n, int | float) and not isinstance(n, bool) and 0.0 <= n < math.inf for n in numbers):
        return [float(n) for n in numbers] if isinstance(value, list) else float(value)
    raise ValueError("must be a number of 0 or more, a list of such with one for each joint, or the name of a set")


Armature = Annotated[float | list[float] | str, BeforeValidator(_armature)]


class ArmConfig(StrictModel):
    """One arm.

    Attributes:
        urdf: URDF of the arm: a built-in file, a file in a config folder of the user, or an absolute path. None if the
            arm has an MJCF.
        mjcf: MJCF (MuJoCo's format) of the arm, found in the same places; None if the arm has a URDF.
        tip: Name of the tip frame.
        home: Joint positions at home, in rad; m for prismatic joints.
        inertials: Name of a set of masses, centres of mass and inertias in `<urdf>.inertials.yaml`, used instead of
            those in the file; None keeps those in the file.
        masses: Mass of links by name, in kg, used instead of that in the file or the set.
        armature: Reflected inertia of motor and gear, N^2 J, in kg m^2; kg for prismatic joints. It adds only to the
            diagonal of the mass matrix. One value for all joints, a list with one for each, or the name of a set in
            `<urdf>.armature.yaml`.
        velocity_limits: Largest speed of joints by name, in rad/s; m/s for prismatic joints. It replaces the limit in
            the file; an MJCF has none.
    """

    urdf: FileName | None
    mjcf: FileName | None
    tip: Name
    home: JointPosition[list[float]]
    inertials: Name | None
    masses: Kilograms[dict[str, PositiveFloat]]
    armature: JointInertia[Armature]
    velocity_limits: JointSpeed[dict[str, PositiveFloat]]


class StageConfig(ArmConfig):
    """One arm of several, from the base outwards.

    Attributes:
        mount: Mount on the arm below; None only for the first stage.
    """

    mount: MountConfig | None


class PayloadChange(StrictModel):
    """Change of the payload at a time.

    Attributes:
        at: Time of the change, in s; it takes effect at the first tick from this time on.
        mass: Mass of the payload from then on, in kg.
    """

    at: Seconds[PositiveFloat]
    mass: Kilograms[NonNegativeFloat]


class PayloadConfig(StrictModel):
    """A point mass fixed at the tip, which both the plant and the controllers' model contain.

    Attributes:
        mass: Mass of the payload, in kg.
        position: Position in the tip frame, in m.
        schedule: Changes of the simulated arm's payload during the run, such as `{at: 1.5, mass: 2.0}`, in s and kg, in
            order of time. The controllers' model keeps `mass`.
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
        """Largest mass during the run, in kg."""
        return max([self.mass, *(change.mass for change in self.schedule)])


class RobotConfig(StrictModel):
    """A robot of one arm or several, with the values of its sources; other groups use them as `${robot.x}`.

    Attributes:
        name: Name of the robot.
        start: Tip position where trajectories start, in m; None for the tip at home.
        goal: Tip position at the end of goal, quintic and line, in m.
        path_size: Size of paths that have one, such as the radius of a circle, in m.
        tool: Tool fixed on the tip frame; the tip of the tool is then controlled. None for no tool.
        friction: Joint friction in plants that take torques, for the joints of all stages.
        payload: Payload at the tip.
        rated_payload: Largest payload that the manufacturer allows, in kg; None if none is stated.
        natural_frequency: omega_n of the controller, in rad/s; by stage if the robot has several.
        damping_ratio: xi of the controller; by stage if the robot has several.
        period: Period of the controller, in s; by stage if the robot has several.
        joint_error_limit: Error of joint positions, in rad; m for prismatic joints. By stage if the robot has several.
        no_joint_error: Zero for each stage, which `noise: none` uses.
        torque_limit: Largest continuous torque, in N m; N for prismatic joints. By stage if the robot has several; None
            if the sources state only the efforts in the URDF.
        settling_band: Largest tip error of a settled motion on each axis, in m.
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
        """Arms by name, from the base outwards."""
        raise NotImplementedError

    @property
    def burden(self) -> float:
        """Largest mass of tool and payload together, in kg."""
        return self.payload.largest + (0.0 if self.tool is None else self.tool.mass)

    @property
    def warnings(self) -> list[str]:
        """Warnings about unusual values, for a calibration; a run has a caveat instead."""
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
        """The only stage, with the name of the robot."""
        return {self.name: self}


class StagedRobotConfig(RobotConfig):
    """A robot of arms mounted on each other.

    Attributes:
        stages: The arms by name, from the base outwards.
    """

    stages: Annotated[dict[str, StageConfig], Field(min_length=2)]

    @property
    def arms(self) -> dict[str, StageConfig]:
        """Stages of the robot."""
        return self.stages
