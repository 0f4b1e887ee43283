"""Plants (simulated arms): true motion from joint torques or commanded joint positions; registry and features."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.plants.computation import EXACT, ComputationConfig
from runner.plants.decoupled import Motion
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.plant import Plant, PositionPlant
from runner.plants.servo import ServoConfig
from runner.plugins.features import Features, read_features
from runner.plugins.guard import Asked, Attribute, Guard, Method, checked, refuse
from runner.plugins.registry import KindConfig, Registry
from runner.robots.robot import Robot
from runner.robots.vibration import Mode


class PlantConfig(KindConfig, Protocol):
    """The config of a plant."""

    @property
    def step(self) -> float | None:
        """Integration step, in s; None leaves it to the plant's module."""
        ...


@dataclass(frozen=True)
class PlantOptions:
    """Optional keys of a plant's config, with the values for a config without them.

    Attributes:
        wrist_rotation: Whether the base stage rotates the base of the mounted stage.
        computation: Delay and misses of commands.
        flexible_joints: Springs between motors and links; None for rigid joints.
        servo: Position servos of a torque plant, for controllers that command joint positions; None without servos.
    """

    wrist_rotation: Literal["real", "parallel"] = "real"
    computation: ComputationConfig = EXACT
    flexible_joints: FlexibleJointsConfig | None = None
    servo: ServoConfig | None = None


def options_of(config: PlantConfig) -> PlantOptions:
    """Return the optional keys of a plant's config."""
    return read_features(PlantOptions, config)


@dataclass(frozen=True)
class PlantFeatures(Features):
    """Optional members of a plant's module.

    Attributes:
        IMPLICIT_CONTACT: True if the plants compute the contact force of a wall in each step, from the velocity at the
            end of the step.
        STOPS: True if the plants stop joints at their position limits, with some compliance.
        default_step: Function of the control tick, in s, and the number of stages. It returns the integration step, in
            s, for a config without step.
        motion: Function of the config, the robot, the step in s, and the steps in a tick. It returns the motion of the
            plants for compiled runs: rigid bodies with friction by the classical Runge-Kutta scheme, or an arm by
            Bullet's step. It returns None if the plants move otherwise.
        modes: Function of the config, the robot and a configuration. It returns the modes of a flexible robot with its
            motors held, by frequency; see find_modes.
        moves_exactly: Function of the config. It returns True if a step integrates positions exactly under a constant
            force, and False if it uses the velocity at its end.
    """

    IMPLICIT_CONTACT: bool = False
    STOPS: bool = False
    default_step: Callable[[float, int], float] = lambda tick, stages: tick
    motion: Callable[[Any, Robot, float, int], Motion | None] = lambda config, robot, step, steps_per_tick: None
    modes: Callable[[Any, Robot, FloatArray], list[Mode]] = lambda config, robot, q: []
    moves_exactly: Callable[[Any], bool] = lambda config: False


def _check_state(_: Any, asked: Asked, q: FloatArray, dq: FloatArray) -> None:
    for name in ("q", "dq"):
        found = np.shape(getattr(asked.part, name))
        if found != q.shape:
            raise SimulationError(f"{type(asked.part).__name__}.{name} has the shape {found}; it must be {q.shape}")


def _check_wrench(answer: Any, asked: Asked) -> FloatArray | None:
    return None if answer is None else checked(answer, (6,), asked)


def _innermost(part: Any) -> Any:
    """Return the user-supplied plant that moves the arm, inside all wrappers, also those without a base class."""
    while hasattr(part, "plant"):
        part = part.plant
    return part


GUARD = Guard(
    "plant",
    Plant,
    q=Attribute(),
    dq=Attribute(),
    tau=Attribute(optional=True),
    load=Attribute(optional=True),
    reset=Method(_check_state),
    set_gravity=Method(),
    advance=Method(),
    close=Attribute(),
    add_wall=Method(lambda answer, *_: answer is not False, optional=True, owner=_innermost, fail=refuse),
    contact_wrench=Method(_check_wrench, optional=True, owner=_innermost),
    tool_reaction=Method(_check_wrench, optional=True, owner=_innermost),
)
"""Checks of a user-supplied plant."""


class Plants(Registry[PlantConfig, [Robot, float, int], Plant]):
    """The registry of plants.

    `build` takes the robot and two numbers. For torque plants, these are the step, in s, and the steps in a tick. For
    position plants, these are the tick, in s, and the ticks between commands.
    """

    def features(self, kind: str) -> PlantFeatures:
        """Return the optional members of a kind's module."""
        return read_features(PlantFeatures, self.module(kind))

    def motion(self, config: PlantConfig, robot: Robot, step: float, steps_per_tick: int) -> Motion | None:
        """Return the motion of a plant for compiled runs, or None; see PlantFeatures.

        Raises:
            ConfigError: see find_motion.
        """
        return self.features(config.kind).motion(config, robot, step, steps_per_tick)

    def modes(self, config: PlantConfig, robot: Robot, q: FloatArray) -> list[Mode]:
        """Return the modes of a plant about a configuration, motors held; none if it is rigid."""
        return self.ask(config, self.features(config.kind).modes, robot, q)


PLANTS = Plants(
    "plant",
    {
        "bullet": "runner.plants.bullet",
        "kinematic": "runner.plants.kinematic",
        "mujoco": "runner.plants.mujoco",
        "rk4": "runner.plants.rk4",
        "rk4_flexible_links": "runner.plants.rk4_flexible_links",
    },
    GUARD,
)

__all__ = [
    "PLANTS",
    "Plant",
    "PlantConfig",
    "PositionPlant",
]
