"""Config of the robot: one arm, or arms riding on each other."""

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.config.per_stage import NonNegativePerStage, PositivePerStage, TorquePerStage
from runner.registry import StrictModel

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Name = Annotated[str, Field(min_length=1, max_length=200)]
FileName = Annotated[str, Field(min_length=1)]


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
        rotor_inertia: Inertia added to each moving link about its joint's axis, in kg m^2.
        velocity_limits: Largest speed of joints by name, in rad/s; m/s where a joint slides. They stand in place of the
            file's; an MJCF has none.
    """

    urdf: FileName | None
    mjcf: FileName | None
    tip: Name
    home: list[float]
    inertials: Name | None
    masses: dict[str, PositiveFloat]
    rotor_inertia: NonNegativeFloat
    velocity_limits: dict[str, PositiveFloat]


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


class PayloadConfig(StrictModel):
    """A point mass fixed at the tip, which both the plant and the controllers' model hold.

    Attributes:
        mass: Its mass, in kg.
        position: Its place in the tip frame, in m.
    """

    mass: NonNegativeFloat
    position: Vector


class ToolConfig(StrictModel):
    """A rigid tool on the flange, which both the plant and the controllers' model hold; its tip is what is controlled.

    Attributes:
        mass: In kg.
        centre_of_mass: In the flange's frame, in m.
        inertia: Principal moments about the centre of mass, along the flange's axes, in kg m^2.
        tip: Its tip, the tool centre point, in the flange's frame, in m.
        tip_radius: Radius of the ball at its tip that touches walls, in m.
    """

    mass: PositiveFloat
    centre_of_mass: Vector
    inertia: Annotated[list[PositiveFloat], Field(min_length=3, max_length=3)]
    tip: Vector
    tip_radius: PositiveFloat


class RobotConfig(StrictModel):
    """A robot of one arm or of several, by the values of its sources; other groups take them as `${robot.x}`.

    Attributes:
        name: Its name.
        start: Tip position where trajectories start, in m; None is the tip at home.
        goal: Tip position that goal, quintic and line go to, in m.
        path_size: Size of the paths that have one, such as a circle's radius, in m.
        tool: What is fixed on its tip frame, whose own tip is controlled then; None for nothing.
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
    start: Vector | None
    goal: Vector
    path_size: PositiveFloat
    tool: ToolConfig | None
    payload: PayloadConfig
    rated_payload: PositiveFloat | None
    natural_frequency: PositivePerStage
    damping_ratio: PositivePerStage
    period: PositivePerStage
    joint_error_limit: NonNegativePerStage
    no_joint_error: NonNegativePerStage
    torque_limit: TorquePerStage | None
    settling_band: PositiveFloat

    @property
    def arms(self) -> Mapping[str, ArmConfig]:
        """Its arms by name, from the base outwards."""
        raise NotImplementedError

    @property
    def burden(self) -> float:
        """Mass of what its tip carries, tool and payload, in kg."""
        return self.payload.mass + (0.0 if self.tool is None else self.tool.mass)

    @property
    def warnings(self) -> list[str]:
        """What is unusual in these values though a calibration goes on; a run has a caveat in their place."""
        tool = 0.0 if self.tool is None else self.tool.mass
        if self.rated_payload is None or self.burden <= self.rated_payload:
            return []
        borne = (
            f"robot.payload.mass: {self.payload.mass:g} kg is"
            if self.tool is None
            else (f"robot.tool.mass and robot.payload.mass: {tool:g} and {self.payload.mass:g} kg are")
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
