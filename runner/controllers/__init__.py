"""Controllers: joint torques or positions from time, measurement and reference; registry and optional features."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import ModuleType
from typing import Any, Protocol, runtime_checkable

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import ControlLaw, Controller, Loop, PositionController
from runner.controllers.force.admittance_filter import Admittance
from runner.plugins.discovery import functions_in_use
from runner.plugins.features import Features, read_features
from runner.plugins.guard import Attribute, Guard, Method, array, checked, find_fault, refuse
from runner.plugins.registry import KindConfig, Registry
from runner.robots.robot import Robot


class ControllerConfig(KindConfig, Protocol):
    """The config of a controller."""

    @property
    def period(self) -> float | Mapping[str, float]:
        """Time between two ticks, in s; a mapping has one for the loop of each stage."""
        ...


def _no_posture(config: Any, robot: Robot, start: FloatArray) -> FloatArray | None:
    return None


@dataclass(frozen=True)
class ControllerFeatures(Features):
    """Optional members of the module of a controller.

    Attributes:
        FOLLOWS_PATHS: True if an ideal arm under its laws follows every path that the arm can follow. A path that
            it would leave is rejected before the run, with the reason.
        FOLLOWS_JOINTS: True if its laws can follow a desired joint motion. `build` then has an argument `joints`. If
            that is True, the loops take a reference of shape (3, nq): joint positions, velocities and accelerations.
        TAKES_DRAWN: True if `build` also takes a robot whose models are DrawnModels. The nominal models of several
            repetitions are then drawn as arrays.
        start_posture: Function of the config, the robot and the start of the tip, shape (3,), in m, that returns the
            joint positions at the start, shape (nq,), in rad, or None for no preference. It raises a LinAlgError if
            there is no such configuration.
    """

    FOLLOWS_PATHS: bool = False
    FOLLOWS_JOINTS: bool = False
    TAKES_DRAWN: bool = False
    start_posture: Callable[[Any, Robot, FloatArray], FloatArray | None] = _no_posture


@runtime_checkable
class FollowsWithinReach(Protocol):
    """A config of controllers whose mounted stage follows its target up to a distance, which a metric reports."""

    reach: float


@runtime_checkable
class ChecksStability(Protocol):
    """A config of compliant controllers that can reject a wall on which the arm would bounce.

    The wall is rejected only if the joints follow commands exactly. With joint servos, stability also depends on them.
    """

    check_stability: bool
    period: float

    @property
    def law(self) -> Admittance:
        """The admittance: mass, damping and stiffness."""
        ...


@runtime_checkable
class CommandsForce(ChecksStability, Protocol):
    """A config of such controllers with the reference point of the wrench and the compensation of the reading."""

    wrench_frame: str
    compensation: str


def guard_law(law: Any, joints: int) -> Any:
    """Return a user-supplied control law behind its checks.

    Args:
        law: The law.
        joints: Number of joints that it commands.
    """
    return Guard(
        "controller",
        ControlLaw,
        reset=Method(),
        torque=Method(array(joints)),
        joint_positions=Method(array(joints)),
        external_wrench=Attribute(lambda answer, asked: checked(answer, (6,), asked._replace(name="update_wrench"))),
        update_wrench=Method(),
        messages=Method(lambda answer, _: list(map(str, answer)), fail=lambda _, fault: [fault]),
        with_limits=Method(lambda answer, asked, _: asked.guard(answer), optional=True, fail=refuse),
    )(law)


def guard_loops(loops: Any, _: object, robot: Robot) -> tuple[Loop, ...]:
    """Return the loops of a user-supplied module with guarded laws.

    Raises:
        ConfigError: if they are not a sequence of Loop, or do not command every joint once.
    """
    if not (isinstance(loops, Sequence) and loops and all(isinstance(loop, Loop) for loop in loops)):
        raise ConfigError(f"controller.kind: build gave {loops!r:.200}; it must give a tuple of Loop")
    commanded = [range(robot.model.nq)[loop.joints] for loop in loops]
    if sorted(joints := [index for own in commanded for index in own]) != list(range(robot.model.nq)):
        raise ConfigError(
            f"controller.kind: its loops command the joints {sorted(joints)}; together they must command each of "
            f"the {robot.model.nq} once"
        )
    pairs = zip(loops, commanded, strict=True)
    return tuple(replace(loop, controller=guard_law(loop.controller, len(own))) for loop, own in pairs)


def tell_limits(loops: Sequence[Loop], limits: FloatArray) -> tuple[Loop, ...]:
    """Return the loops with the torque limits set in their controllers; see ControlLaw.

    Args:
        loops: The loops.
        limits: Torque limits of all joints, shape (nq,), in N m; infinite if there is none.

    Raises:
        ConfigError: if a user-supplied controller fails.
    """
    return tuple(replace(loop, controller=loop.controller.with_limits(limits[loop.joints])) for loop in loops)


class Controllers(Registry[ControllerConfig, [Robot], tuple[Loop, ...]]):
    """The kinds of controllers."""

    def features(self, kind: str) -> ControllerFeatures:
        """Return the optional members of the module of a kind."""
        return read_features(ControllerFeatures, self.module(kind))

    def build_for(self, config: ControllerConfig, robot: Robot, joints: bool) -> tuple[Loop, ...]:
        """Build the loops of a config; a controller follows the joints if it can and `joints` is True.

        Raises:
            ConfigError: see `build`.
        """
        if not (joints and self.features(config.kind).FOLLOWS_JOINTS):
            return self.build(config, robot)
        return self.build_by(partial(self.module(config.kind).build, joints=True), config, robot)

    def module(self, kind: str) -> ModuleType:
        """Return the module of a kind; see Kinds. A kind that is one function has the module of function_module."""
        module = super().module(kind)
        functions = {point.name: point.attr for point in functions_in_use(self.group)}
        if kind in self._modules or kind not in functions:
            return module
        from runner.controllers.joint_space.function_law import function_module  # for few runs

        return function_module(getattr(module, functions[kind], None), kind, module)

    def of_functions(self) -> dict[str, ModuleType]:
        """Return the modules of the controllers that are one function, by kind.

        Raises:
            ConfigError: if one cannot be a controller, or has the name of a built-in controller.
        """
        kinds = [point.name for point in functions_in_use(self.group)]
        problems = [f"{self.group}.kind: '{kind}' is a built-in kind; rename your function" for kind in kinds
                    if kind in self._modules]  # fmt: skip
        if problems:
            raise ConfigError(problems)
        return {kind: self.module(kind) for kind in kinds}

    def start_posture(self, config: ControllerConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
        """Return the joint positions at the start of a trajectory, or None for no preference; see ControllerFeatures.

        Raises:
            ConfigError: if the module does not return a configuration of the robot.
            numpy.linalg.LinAlgError: if there is no such configuration.
        """
        features = self.features(config.kind)
        wanted = self.ask(config, features.start_posture, robot, start)
        fault = None if wanted is None else find_fault(wanted, robot.home.shape)
        if fault:
            raise ConfigError(f"controller.kind: start_posture of '{config.kind}' gave {fault}")
        return wanted


CONTROLLERS = Controllers(
    "controller",
    {
        "adaptive": "runner.controllers.joint_space.adaptive",
        "admittance": "runner.controllers.force.admittance",
        "computed_torque": "runner.controllers.joint_space.computed_torque",
        "differential_inverse_kinematics": "runner.controllers.kinematic.differential_inverse_kinematics",
        "hybrid_force": "runner.controllers.force.hybrid_force",
        "impedance": "runner.controllers.force.impedance",
        "iterative_learning": "runner.controllers.joint_space.iterative_learning",
        "joint_pd": "runner.controllers.joint_space.joint_pd",
        "joint_pid": "runner.controllers.joint_space.joint_pid",
        "macro_mini": "runner.controllers.macro_mini.macro_mini",
        "motor_pd": "runner.controllers.joint_space.motor_pd",
        "operational_space": "runner.controllers.operational_space.operational_space",
        "passivity": "runner.controllers.joint_space.passivity",
        "sliding_mode": "runner.controllers.joint_space.sliding_mode",
        "whole_body": "runner.controllers.operational_space.whole_body",
    },
    guard_loops,
)

__all__ = ["CONTROLLERS", "Controller", "ControllerConfig", "Loop", "PositionController"]
