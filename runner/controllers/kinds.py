"""Optional features of controller modules and configs, beyond `CONFIG` and `build`; registry of controllers."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, runtime_checkable

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import ControlLaw, Loop
from runner.controllers.force.admittance_filter import Admittance
from runner.plugins.features import Features, read_features
from runner.plugins.guard import Attribute, Guard, Method, array, checked, find_fault, refuse
from runner.plugins.registry import KindConfig, Registry
from runner.robots.robot import Robot


class ControllerConfig(KindConfig, Protocol):
    """The config of a controller."""

    @property
    def period(self) -> float | Mapping[str, float]:
        """Time between two ticks of its loop, in s; of each stage's loop by stage."""
        ...


def _no_posture(config: Any, robot: Robot, start: FloatArray) -> FloatArray | None:
    return None


@dataclass(frozen=True)
class ControllerFeatures(Features):
    """Optional members of the module of a controller.

    Attributes:
        FOLLOWS_PATHS: True if its laws bring a perfect arm along any path that the arm can follow. A path that they
            would leave is rejected before the run, with the reason.
        FOLLOWS_JOINTS: True if its laws follow a motion of the joints, if the desired motion is one. Their reference
            then has shape (3, nq): joint positions, velocities and accelerations. `build` then takes `joints`, and
            makes the loops of such a law if that is True.
        start_posture: Function of the config, the robot and the start of the tip, shape (3,), in m, that returns the
            joint positions at the start, shape (nq,), in rad, or None for no preference. It raises a LinAlgError if
            there is no posture.
    """

    FOLLOWS_PATHS: bool = False
    FOLLOWS_JOINTS: bool = False
    start_posture: Callable[[Any, Robot, FloatArray], FloatArray | None] = _no_posture


@runtime_checkable
class FollowsWithinReach(Protocol):
    """A config of controllers whose rider follows its target up to a distance; a metric tells how often it is out."""

    reach: float


@runtime_checkable
class ChecksStability(Protocol):
    """A config of controllers that give way by a law, and may refuse a wall on which they would bounce.

    It is refused where joints go where they are told; behind servos the law does not decide alone.
    """

    check_stability: bool
    period: float

    @property
    def law(self) -> Admittance:
        """The law: mass, damping and stiffness."""
        ...


@runtime_checkable
class CommandsForce(ChecksStability, Protocol):
    """A config of such controllers with the point of the wrench, and the compensation of the reading."""

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
        ConfigError: if they are no loops, or do not command every joint once.
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
    """Return loops with controllers that know their torque limits; see ControlLaw.

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
        """Make the loops of a config, of a law of ours that follows joints where the desired motion is one of joints.

        Raises:
            ConfigError: see `build`.
        """
        if joints and self.is_ours(config.kind) and self.features(config.kind).FOLLOWS_JOINTS:
            loops: tuple[Loop, ...] = self.module(config.kind).build(config, robot, joints=True)
            return loops
        return self.build(config, robot)

    def start_posture(self, config: ControllerConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
        """Return the joint positions at the start of a trajectory, or None for no preference; see ControllerFeatures.

        Raises:
            ConfigError: where a module of the user's gives no posture of the robot.
            numpy.linalg.LinAlgError: where there is none.
        """
        features = self.features(config.kind)
        if self.is_ours(config.kind):
            return features.start_posture(config, robot, start)
        wanted = self.ask(config, features.start_posture, robot, start)
        fault = None if wanted is None else find_fault(wanted, robot.home.shape)
        if fault:
            raise ConfigError(f"controller.kind: start_posture of '{config.kind}' gave {fault}")
        return wanted
