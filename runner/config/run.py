"""A checked config, with what the checks already had to build."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from runner.config.limits import LimitsConfig
from runner.config.noise import NoiseConfig
from runner.config.robot import RobotConfig
from runner.config.sweep import SweepConfig
from runner.config.torque_limits import TorqueLimitsConfig
from runner.plants import PLANTS
from runner.registry import StrictModel
from runner.robots.mismatch import MismatchConfig
from runner.robots.model import FloatArray, RobotModel
from runner.robots.robot import Robot
from runner.sensing import ForceTorqueConfig
from runner.trajectories import Trajectory


class RunSettings(StrictModel):
    """The keys at the root of a config.

    Attributes:
        seed: Seed from which, with the repetition, every random number follows.
        repetitions: Number of closed-loop runs in the job.
        duration: Length of a run, in s; None leaves it to the trajectory.
        gravity: Magnitude of gravity along -z of the base, in m/s^2, for the plant and the controllers' model.
        outputs: Folder in which runs are stored.
    """

    seed: NonNegativeInt
    repetitions: PositiveInt
    duration: PositiveFloat | None
    gravity: NonNegativeFloat
    outputs: Annotated[str, Field(min_length=1)]


@dataclass(frozen=True)
class RunConfig:
    """A config in which every check has passed.

    Attributes:
        settings: The keys at the root.
        plant: Config of the plant, of the model that its kind names.
        controller: Config of the controller, likewise.
        trajectory: Config of the trajectory, likewise.
        noise: Config of the joint measurement.
        torque_limits: Config of the torque limits.
        environment: Config of the world around the tip, likewise.
        wrist_sensor: Config of the force/torque sensor.
        mismatch: How what the controllers believe of the robot differs from it.
        robot: Config of the robot.
        sweep: How a sweep that the run is part of is run.
        limits: What a command may cost.
        arm: The robot's rigid-body model, stage by stage.
        tick: Period of the fastest loop, in s: of the controller, or of the servo below it.
        commands: Whether the controller gives joint torques, or joint positions to a plant that follows them.
        step: Integration step of the plant, in s.
        steps_per_tick: Integration steps in one tick.
        delay: Ticks from a command until it acts.
        path: The desired motion of the tip.
        ticks: Number of ticks of the run.
        resolved: The composed config as plain data, interpolations resolved.
    """

    settings: RunSettings
    plant: Any
    controller: Any
    trajectory: Any
    noise: NoiseConfig
    torque_limits: TorqueLimitsConfig
    environment: Any
    wrist_sensor: ForceTorqueConfig
    mismatch: MismatchConfig
    robot: RobotConfig
    sweep: SweepConfig
    limits: LimitsConfig
    arm: Robot
    tick: float
    commands: Literal["torque", "position"]
    step: float
    steps_per_tick: int
    delay: int
    path: Trajectory
    ticks: int
    resolved: Mapping[str, Any]

    @property
    def warnings(self) -> list[str]:
        """What is unusual in the config though it can be run."""
        model, found = self.arm.model, list(self.robot.warnings)
        if PLANTS.commands(self.plant.kind) == "torque":
            found += _zero_limits("effort", model.effort_limits, "nothing pushes it", model)
        if self.commands == "position":
            found += _zero_limits("velocity", model.velocity_limits, "it stands still", model)
        return found

    @property
    def parallel(self) -> bool:
        """Whether riding stages keep the orientation of home, in the plant's truth."""
        return len(self.arm.stages) > 1 and self.plant.wrist_rotation == "parallel"


def _zero_limits(kind: str, limits: FloatArray, so: str, model: RobotModel) -> list[str]:
    """Return a warning for each joint with a limit of zero: many programs write 0 where they know none."""
    return [
        f"robot.urdf: joint '{name}' has the {kind} limit 0, and {so}; is its limit missing?"
        for name, limit in zip(model.joint_names, limits, strict=True)
        if limit == 0.0
    ]
