"""Optional features of controller modules and configs, beyond `CONFIG` and `build`; registry of controllers."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Controller, Loop
from runner.controllers.force.admittance_filter import Admittance
from runner.plugins.guard import Attribute, Guard, Method, array, checked, find_fault, refuse
from runner.plugins.registry import KindConfig, Registry
from runner.robots.robot import Robot


class ControllerConfig(KindConfig, Protocol):
    """The config of a controller."""

    @property
    def period(self) -> float | Mapping[str, float]:
        """Time between two ticks of its loop, in s; of each stage's loop by stage."""
        ...


@runtime_checkable
class FollowsPaths(Protocol):
    """A module that says whether its controllers bring a perfect arm along any path that the arm can follow.

    Where they do, a path that they leave is refused before the run, with the reason.
    """

    FOLLOWS_PATHS: bool


@runtime_checkable
class ChoosesStart(Protocol):
    """A module that chooses the posture in which the arm starts."""

    def start_posture(self, config: ControllerConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
        """Return joint positions, shape (nq,), in rad, with the tip at start, shape (3,), in m; None for no wish.

        Raises:
            numpy.linalg.LinAlgError: where there are none.
        """
        ...


@runtime_checkable
class FollowsJoints(Protocol):
    """A module whose laws follow a motion of the joints where the desired motion is one; all others follow the tip's.

    The reference of such a law has shape (3, nq): joint positions, velocities and accelerations.
    """

    FOLLOWS_JOINTS: bool

    def build(self, config: ControllerConfig, robot: Robot, joints: bool = False) -> tuple[Loop, ...]:
        """Make the loops; with `joints` they are those of a law that follows joints, and say so."""
        ...


@runtime_checkable
class SupportsTorqueLimits(Protocol):
    """A controller that is told the torque limits of the joints it commands."""

    def with_limits(self, limits: FloatArray) -> Controller:
        """Return the controller that knows limits, shape (n,), in N m; infinite where there is none."""
        ...


@runtime_checkable
class ReadsJointTorques(Protocol):
    """A control law that is told what the joint torque sensors read, at its ticks but the first."""

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Take the mean torques on the links since the last tick, of every joint, shape (nq,), in N m."""
        ...


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
    """Return loops with controllers that know their torque limits; see SupportsTorqueLimits.

    Args:
        loops: The loops.
        limits: Torque limits of all joints, shape (nq,), in N m; infinite if there is none.

    Raises:
        ConfigError: if a user-supplied controller fails.
    """
    return tuple(
        replace(loop, controller=loop.controller.with_limits(limits[loop.joints]))
        if isinstance(loop.controller, SupportsTorqueLimits)
        else loop
        for loop in loops
    )


class Controllers(Registry[ControllerConfig, [Robot], tuple[Loop, ...]]):
    """The kinds of controllers."""

    def build_for(self, config: ControllerConfig, robot: Robot, joints: bool) -> tuple[Loop, ...]:
        """Make the loops of a config, of a law of ours that follows joints where the desired motion is one of joints.

        Raises:
            ConfigError: see `build`.
        """
        module = self.module(config.kind)
        if joints and self.is_ours(config.kind) and isinstance(module, FollowsJoints) and module.FOLLOWS_JOINTS:
            loops: tuple[Loop, ...] = module.build(config, robot, joints=True)
            return loops
        return self.build(config, robot)

    def follows_paths(self, kind: str) -> bool:
        """Tell whether a kind follows any path that the arm can follow; see FollowsPaths."""
        module = self.module(kind)
        return isinstance(module, FollowsPaths) and bool(module.FOLLOWS_PATHS)

    def start_posture(self, config: ControllerConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
        """Return where the arm stands at a trajectory's start, or None where the kind has no wish; see ChoosesStart.

        Raises:
            ConfigError: where a module of the user's gives no posture of the robot.
            numpy.linalg.LinAlgError: where there is none.
        """
        module = self.module(config.kind)
        if not isinstance(module, ChoosesStart):
            return None
        wanted: FloatArray | None
        if self.is_ours(config.kind):
            wanted = module.start_posture(config, robot, start)
            return wanted
        wanted = self.ask(config, module.start_posture, robot, start)
        fault = None if wanted is None else find_fault(wanted, robot.home.shape)
        if fault:
            raise ConfigError(f"controller.kind: start_posture of '{config.kind}' gave {fault}")
        return wanted
