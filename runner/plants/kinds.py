"""Optional features of plant modules and configs, beyond `CONFIG` and `build`; registry of plants."""

from types import ModuleType
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np

from runner.base import engines
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, SimulationError
from runner.plants.computation import ComputationConfig
from runner.plants.decoupled import Motion
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.plant import Plant, unwrapped
from runner.plants.servo import ServoConfig
from runner.plugins.guard import Asked, Attribute, Guard, Method, array, checked, refuse
from runner.plugins.registry import KindConfig, Registry
from runner.robots.modes import Mode
from runner.robots.robot import Robot


class PlantConfig(KindConfig, Protocol):
    """The config of a plant."""

    @property
    def step(self) -> float | None:
        """Integration step, in s; None leaves it to the plant's module."""
        ...


@runtime_checkable
class RotatesMountedBase(Protocol):
    """A config of plants that says whether a carrier turns its rider's base; with one that does not, it does."""

    wrist_rotation: Literal["real", "parallel"]


@runtime_checkable
class ComputesLate(Protocol):
    """A config of plants with what a computer does to a controller's commands; without, they act at once."""

    computation: ComputationConfig


@runtime_checkable
class HasFlexibleJoints(Protocol):
    """A config of plants whose joints may have springs between motors and links; None where they are rigid."""

    flexible_joints: FlexibleJointsConfig | None


@runtime_checkable
class HasServo(Protocol):
    """A config of plants that take torques, with servos for controllers that command joint positions."""

    servo: ServoConfig


@runtime_checkable
class ContactsImplicitly(Protocol):
    """A module whose plants make contacts themselves, and says whether in each step, from the velocity at its end."""

    IMPLICIT_CONTACT: bool


@runtime_checkable
class MovesExactly(Protocol):
    """A module that says whether a step moves positions exactly under a held force, or by the velocity at its end."""

    def moves_exactly(self, config: PlantConfig) -> bool:
        """Tell it of a config."""
        ...


@runtime_checkable
class MovesByRungeKutta(Protocol):
    """A module whose plants are the classical Runge-Kutta scheme on a motion, so that runs may be compiled whole."""

    def motion(self, config: PlantConfig, robot: Robot) -> Motion | None:
        """Return what a plant moves; None where this plant is more than rigid bodies with friction."""
        ...


@runtime_checkable
class HasModes(Protocol):
    """A module whose plants are flexible, and tells how they ring; springs in joints are known by HasFlexibleJoints."""

    def modes(self, config: PlantConfig, robot: Robot, q: FloatArray) -> list[Mode]:
        """Return the modes of a robot about a posture with its motors held, by frequency; see find_modes."""
        ...


@runtime_checkable
class IsFallback(Protocol):
    """A config of plants that may stand in for another kind, which is missing; None where nothing is missing."""

    in_place_of: str | None


@runtime_checkable
class ChoosesStep(Protocol):
    """A module that chooses the integration step if the config gives none; the default is the control tick."""

    def default_step(self, tick: float, stages: int) -> float:
        """Return the step for a control tick, in s, and a number of stages, in s."""
        ...


def _check_state(_: Any, asked: Asked, q: FloatArray, dq: FloatArray) -> None:
    """Check the shapes of a plant's state after a reset."""
    for name in ("q", "dq"):
        found = np.shape(getattr(asked.part, name))
        if found != q.shape:
            raise SimulationError(f"{type(asked.part).__name__}.{name} has the shape {found}; it must be {q.shape}")


def _check_reaction(answer: Any, asked: Asked) -> FloatArray | None:
    """Return the reaction in the mount of a tool, if there is one."""
    return None if answer is None else checked(answer, (6,), asked)


GUARD = Guard(
    "plant",
    q=Attribute(),
    dq=Attribute(),
    tau=Attribute(optional=True),
    load=Attribute(optional=True),
    reset=Method(_check_state),
    set_gravity=Method(),
    advance=Method(),
    close=Attribute(),
    add_wall=Method(optional=True, owner=unwrapped, fail=refuse),
    contact_wrench=Method(array(6), optional=True, owner=unwrapped),
    tool_reaction=Method(_check_reaction, optional=True, owner=unwrapped),
)
"""Checks of a user-supplied plant."""


class Plants(Registry[PlantConfig, [Robot, float, int], Plant]):
    """The kinds of plants.

    `build` gives each the robot and two numbers. Plants that take torques get their step, in s, and the steps in a
    tick; those that follow joint positions the tick, in s, and the ticks from one command to the next.
    """

    def names(self) -> list[str]:
        """Return the known kinds; see Kinds. Without PyBullet bullet is none of them."""
        return [kind for kind in super().names() if kind != "bullet" or engines.has_pybullet()]

    def module(self, kind: str) -> ModuleType:
        """Return the module of a kind.

        Raises:
            ConfigError: see Kinds; and for bullet where PyBullet is missing.
        """
        if kind == "bullet" and not engines.has_pybullet():
            raise ConfigError(engines.bullet_missing())
        return super().module(kind)

    def default_step(self, kind: str, tick: float, stages: int) -> float:
        """Return the step of a kind if its config gives none, in s; see ChoosesStep."""
        module = self.module(kind)
        return module.default_step(tick, stages) if isinstance(module, ChoosesStep) else tick

    def motion(self, config: PlantConfig, robot: Robot) -> Motion | None:
        """Return what a plant moves; None where it is not known to be moved by the Runge-Kutta scheme.

        Raises:
            ConfigError: see find_motion.
        """
        module = self.module(config.kind)
        return module.motion(config, robot) if isinstance(module, MovesByRungeKutta) else None

    def modes(self, config: PlantConfig, robot: Robot, q: FloatArray) -> list[Mode]:
        """Return the modes of a built-in plant about a posture with its motors held, if it may ring; see HasModes."""
        if not self.is_ours(config.kind):
            return []
        if isinstance(config, HasFlexibleJoints) and config.flexible_joints is not None:
            return config.flexible_joints.modes(robot, q)
        module = self.module(config.kind)
        return module.modes(config, robot, q) if isinstance(module, HasModes) else []

    def moves_exactly(self, config: PlantConfig) -> bool:
        """Tell whether a step moves positions exactly under a held force; see MovesExactly."""
        module = self.module(config.kind)
        return isinstance(module, MovesExactly) and module.moves_exactly(config)

    def contacts_implicitly(self, kind: str) -> bool:
        """Tell whether a kind makes contacts in each step, from the velocity at its end; see ContactsImplicitly."""
        module = self.module(kind)
        return isinstance(module, ContactsImplicitly) and bool(module.IMPLICIT_CONTACT)
