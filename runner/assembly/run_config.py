"""Checked config of a run, with the objects that the checks built."""

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import cast

from runner.assembly.timing import Timing
from runner.base.arrays import FloatArray
from runner.base.memory import Memory
from runner.config.composed import Composed
from runner.config.judgement import CaveatsConfig, SpecConfig
from runner.config.limits import LimitsConfig, SweepConfig
from runner.config.robot import RobotConfig
from runner.config.settings import RunSettings
from runner.controllers import CONTROLLERS, ControllerConfig, Loop
from runner.controllers.disturbance_observer import DisturbanceObserverConfig
from runner.controllers.notch import NotchConfig
from runner.environments.wall import WallConfig
from runner.plants import PLANTS, PlantConfig
from runner.plants.motor_limits import TorqueLimits
from runner.plugins.features import Commands
from runner.plugins.registry import KindConfig
from runner.robots.mismatch import MISMATCHES, MismatchConfig
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.sensing import NOISES
from runner.sensing.encoders import EncoderNoise
from runner.sensing.endpoint import TipSensorConfig
from runner.sensing.force_torque import ForceTorqueConfig
from runner.trajectories import Trajectory
from runner.trajectories.joint_motion import TipOfJoints

# Fields that differ between configs of the same run, or that are new objects in each config.
_OF_ONE_RUN = frozenset({"settings", "composed", "loaded", "timing"})
_KEYS = Memory(512)  # a key holds its arm


@dataclass(frozen=True)
class RunConfig:
    """A config in which every check has passed.

    Attributes:
        settings: The keys at the root.
        robot: Config of the robot.
        arm: Rigid-body model of the robot, stage by stage.
        loaded: Time of each change of the simulated arm's payload, in s, and the robot from then on.
        plant: Config of the plant, by the model of its kind.
        controller: Config of the controller, by the model of its kind.
        loops: Control loops of the controller for the robot without model error.
        commands: Quantity that the loops command: joint torques, or joint positions for a plant that follows them.
        path: The desired motion of the tip.
        environment: Config of the environment of the tip, by the model of its kind.
        noise: Noise and steps of each joint's encoder, or the config of encoders of another kind.
        torque_limits: Torque limits of all joints.
        wrist_sensor: Config of the force/torque sensor, by the model of its kind.
        joint_torque_sensor: Errors of each joint's torque sensor, or the config of sensors of another kind; None for
            no sensors.
        endpoint_sensor: Config of the sensor of the tip's position.
        mismatch: Config of the difference between the controllers' model and the robot, by the model of its kind.
        disturbance_observer: Config of the disturbance observer of the control laws.
        notch: Config of the notch filter for torques; None for no filter.
        timing: The times of a run.
        ignore_base_rotation: True if mounted stages keep the orientation of home in the plant.
        sweep: Config of the sweep that contains the run.
        limits: Limits of CPU time and memory.
        caveats: Thresholds of the caveats of a run.
        spec: Bounds on metrics; the runner reports how often they are met.
        composed: The composed config that was checked.
    """

    settings: RunSettings
    robot: RobotConfig
    arm: Robot
    loaded: tuple[tuple[float, Robot], ...]
    plant: PlantConfig
    controller: ControllerConfig
    loops: tuple[Loop, ...]
    commands: Commands
    path: Trajectory
    environment: KindConfig
    noise: KindConfig
    torque_limits: TorqueLimits
    wrist_sensor: KindConfig
    joint_torque_sensor: KindConfig | None
    endpoint_sensor: TipSensorConfig
    mismatch: KindConfig
    disturbance_observer: DisturbanceObserverConfig
    notch: NotchConfig | None
    timing: Timing
    ignore_base_rotation: bool
    sweep: SweepConfig
    limits: LimitsConfig
    caveats: CaveatsConfig
    spec: SpecConfig
    composed: Composed

    @property
    def resolved(self) -> Mapping[str, object]:
        """The composed config as plain data, interpolations resolved."""
        return self.composed.resolved

    def with_seed(self, composed: Composed) -> "RunConfig":
        """Return the same run with the seed of another config, the only difference between the two."""
        _ = self.cache_key, self.encoder_noise, self.model_error, self.interpreted  # computed once, for all copies
        other = copy(self)
        seed = composed.resolved["seed"]
        vars(other).update(settings=self.settings.model_copy(update={"seed": seed}), composed=composed)
        return other

    @property
    def follows_joints(self) -> bool:
        """True if the desired motion is defined for the joints."""
        return isinstance(self.path, TipOfJoints)

    def loops_for(self, robot: Robot) -> tuple[Loop, ...]:
        """Return the control loops with a nominal robot; for the run's own arm they are `loops`.

        Raises:
            ConfigError: if the controller cannot be built for the robot.
        """
        if robot is self.arm:
            return self.loops
        return CONTROLLERS.build_for(self.controller, robot, self.follows_joints)

    @cached_property
    def cache_key(self) -> tuple[object, ...]:
        """All parts of a run but its seed: numbers and shared objects; the same tuple for equal parts, see Memory."""
        parts = (vars(self)[name] for name in self.__match_args__ if name not in _OF_ONE_RUN)
        times = (part for name, part in vars(self.timing).items() if name != "late")
        several = (*self.loaded, self.timing.late)
        key = (*parts, *times, self.settings.repetitions, *(part for each in several for part in each))
        return _KEYS.known(key, lambda: key)

    @cached_property
    def encoder_noise(self) -> EncoderNoise | None:
        """Noise of the encoders that compiled loops contain; None for encoders of another kind."""
        return cast(EncoderNoise, self.noise) if NOISES.is_compiled(self.noise.kind) else None

    @cached_property
    def model_error(self) -> MismatchConfig | None:
        """Factors on the nominal model; None for a mismatch of another kind."""
        return cast(MismatchConfig, self.mismatch) if MISMATCHES.is_compiled(self.mismatch.kind) else None

    @property
    def varies_model(self) -> bool:
        """True if each repetition may have another nominal model."""
        return self.model_error is None or self.model_error.varies

    @cached_property
    def interpreted(self) -> list[str]:
        """Parts without a compiled form, such as "noise=hysteresis", which are interpreted in each control step."""
        parts = ((NOISES, self.noise), (MISMATCHES, self.mismatch))
        return [f"{kinds.group}={part.kind}" for kinds, part in parts if not kinds.is_compiled(part.kind)]

    @property
    def compilable(self) -> bool:
        """True if compiled code supports all sensors of the run and the controllers' model."""
        return not self.interpreted and not self.endpoint_sensor.read_by

    @property
    def takes_torques(self) -> bool:
        """True if the plant takes torques; False if its joints follow positions."""
        return PLANTS.commands(self.plant.kind) == "torque"

    @property
    def wall(self) -> WallConfig | None:
        """Config of the built-in wall; None in another environment."""
        return self.environment if type(self.environment) is WallConfig else None

    @property
    def force_torque_sensor(self) -> ForceTorqueConfig | None:
        """Config of the built-in force/torque sensor; None for a sensor of another kind."""
        return self.wrist_sensor if isinstance(self.wrist_sensor, ForceTorqueConfig) else None

    @property
    def has_contact(self) -> bool:
        """True if the tip may touch something, or if a controller uses the external wrench."""
        return self.environment.kind != "free" or any(loop.uses_wrench for loop in self.loops)

    @property
    def warnings(self) -> list[str]:
        """Warnings about unusual values in a valid config."""
        model = self.arm.model
        file = "robot.mjcf" if any(arm.mjcf for arm in self.robot.arms.values()) else "robot.urdf"
        found: list[str] = []
        if self.takes_torques:
            found += _zero_limits(f"{file}: joint", "effort", model.effort_limits, "nothing pushes it", model)
        if self.commands == "position":
            found += _zero_limits(f"{file}: joint", "velocity", model.velocity_limits, "it stands still", model)
        return found


def _zero_limits(joint: str, kind: str, limits: FloatArray, so: str, model: RobotModel) -> list[str]:
    """Return a warning for each joint with a limit of zero: many programs write 0 for an unknown limit."""
    return [
        f"{joint} '{name}' has the {kind} limit 0, and {so}; is its limit missing?"
        for name, limit in zip(model.joint_names, limits, strict=True)
        if limit == 0.0
    ]
