"""Config of the robot: one arm, or arms riding on each other."""

from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.config.per_stage import NonNegativePerStage, PositivePerStage, TorquePerStage
from runner.registry import StrictModel

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Name = Annotated[str, Field(min_length=1)]


class ArmConfig(StrictModel):
    """One arm.

    Attributes:
        urdf: Its URDF: a file among ours, in a config folder of the user's, or an absolute path.
        tip: Name of its tip frame.
        home: Joint positions at home, in rad.
        masses: Mass of links by name, in kg, in place of the URDF's.
        rotor_inertia: Inertia added to each moving link about its joint's axis, in kg m^2.
    """

    urdf: Name
    tip: Name
    home: list[float]
    masses: dict[str, PositiveFloat]
    rotor_inertia: NonNegativeFloat


class MountConfig(StrictModel):
    """Where an arm is mounted on the one below.

    Attributes:
        frame: Link of the arm below (by its own name there) on which the root link is fixed.
        translation: Origin of the root in that link's frame, in m.
        rotation: Roll, pitch, yaw of the root in that link's frame, in rad.
    """

    frame: Name
    translation: Vector
    rotation: Vector


class StageConfig(ArmConfig):
    """One arm of several, from the base outwards.

    Attributes:
        mount: Where it is mounted; None for the first stage alone.
    """

    mount: MountConfig | None


class RobotValues(StrictModel):
    """The values that a robot's sources give for it; other groups take them as `${robot.x}`.

    Attributes:
        name: Its name.
        goal: Tip position that goal and quintic go to, in m.
        natural_frequency: omega_n of its controller, in rad/s, by stage where it has several; so all that follow.
        damping_ratio: xi of its controller.
        period: Its controller's period, in s.
        joint_error_limit: Error of its joint positions, in rad.
        no_joint_error: Zero for each stage, which `noise: none` takes.
        torque_limit: Its largest continuous torque, in N m.
        settling_band: Tip error within which it counts as settled, on each axis, in m.
    """

    name: Name
    goal: Vector
    natural_frequency: PositivePerStage
    damping_ratio: PositivePerStage
    period: PositivePerStage
    joint_error_limit: NonNegativePerStage
    no_joint_error: NonNegativePerStage
    torque_limit: TorquePerStage
    settling_band: PositiveFloat


class OneArmConfig(RobotValues, ArmConfig):
    """A robot that is one arm."""

    @property
    def arms(self) -> dict[str, ArmConfig]:
        """Its one stage, named after it."""
        return {self.name: self}


class StagedRobotConfig(RobotValues):
    """A robot of arms riding on each other.

    Attributes:
        stages: The arms by name, from the base outwards.
    """

    stages: Annotated[dict[str, StageConfig], Field(min_length=2)]

    @property
    def arms(self) -> dict[str, StageConfig]:
        """Its stages."""
        return self.stages


RobotConfig = OneArmConfig | StagedRobotConfig
