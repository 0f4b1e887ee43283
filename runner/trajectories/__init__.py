"""Trajectories: desired motions of the tip or of the joints."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, RunnerError
from runner.plugins.features import Features, read_features
from runner.plugins.guard import Asked, Guard, Method, checked, describe_fault, find_fault, place, read_only
from runner.plugins.registry import KindConfig, Registry
from runner.trajectories.trajectory import OfTip, Trajectory

if TYPE_CHECKING:  # these modules import Pinocchio, which readers of stored runs do not need
    from runner.robots.robot import Robot
    from runner.trajectories.joint_motion import JointMotion


@runtime_checkable
class HasStart(Protocol):
    """Config of a trajectory with an optional start."""

    start: list[float] | None
    """Tip position at t = 0, in m; None is the tip at home."""


@runtime_checkable
class HasGoal(Protocol):
    """Config of a trajectory with a goal, which must be within reach."""

    goal: list[float] | None
    """Tip position at the end, in m."""


@dataclass(frozen=True)
class TrajectoryFeatures(Features):
    """Optional members of the module of a trajectory.

    Attributes:
        joint_motion: Function of the config and the robot; returns the motion of the joints, or None if the config
            describes a motion of the tip.
    """

    joint_motion: "Callable[[Any, Robot], JointMotion | None]" = lambda config, robot: None


class _ByRun(Method):
    """Rule for a method that is called once for each run if it receives the points of several runs."""

    def bind(self, asked: Asked) -> Any:
        """Return the member of the proxy."""
        ask = super().bind(asked)

        def by_run(points: FloatArray) -> Any:
            return ask(points) if points.ndim < 3 else np.stack([by_run(np.ascontiguousarray(own)) for own in points])

        return by_run


_SAMPLES, _PROBES = 1001, 40  # of a user-supplied motion before a run
_CLOSE = 1e-6  # m, rad
_DERIVATIVES = (("velocity", 0.1), ("acceleration", 0.3))  # and the relative difference that is a fault
_GUARD = Guard(
    "trajectory",
    OfTip,
    sample=Method(lambda motion, asked, times: checked(motion, (len(times), 3, 3), asked)),
    distance_to_path=_ByRun(lambda distances, asked, points: checked(distances, (len(points),), asked)),
)


def guard_trajectory(trajectory: Any, *_: object) -> Any:
    """Return a guarded user-supplied trajectory, with copies of its points and times.

    Raises:
        ConfigError: if the points, the times or the motion are invalid; the message contains the line of the method.
    """
    guarded, problems = _GUARD(trajectory), list[str]()
    try:
        for name in ("duration", "run_duration"):
            value = getattr(trajectory, name)
            if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < np.inf:
                problems.append(f"its {name} is {value!r}; it must be a time in s, 0 or more")
            else:
                setattr(guarded, name, float(value))
        has_times = not problems
        for name in ("start", "goal"):
            point = getattr(trajectory, name)
            fault = None if point is None and name == "goal" else find_fault(point, (3,))
            if fault:
                problems.append(f"its {name} is {fault}")
            else:
                setattr(guarded, name, None if point is None else read_only(np.array(point, dtype=float)))
        guarded.tracked = bool(trajectory.tracked)
        if has_times:
            motion = guarded.sample(np.linspace(0.0, trajectory.duration, _SAMPLES))
            guarded.distance_to_path(motion[:, 0])
            if not problems and guarded.tracked and trajectory.duration > 0.0:
                fault = _find_jump(motion, trajectory.duration, "m") or _find_contradiction(guarded, "m")
                problems += [f"{place(trajectory.sample)} gave {fault}"] if fault else []
    except RunnerError:
        raise
    except Exception as error:
        problems.append(describe_fault(error))
    if problems:
        raise ConfigError(f"trajectory: {type(trajectory).__name__}: {problem}" for problem in problems)
    return guarded


def guard_joint_motion(motion: Any, shape: tuple[int, ...]) -> Any:
    """Return a guarded user-supplied joint motion; its start, duration and number of samples are read once.

    Args:
        motion: The motion; see JointMotion.
        shape: Shape of joint positions, (nq,).

    Raises:
        ConfigError: if one of these is invalid, or if the samples contradict it or each other.
    """
    rule = Method(lambda found, asked, times: checked(found, (len(times), 3, *shape), asked))
    guarded, problems = Guard("trajectory", sample=rule)(motion), list[str]()
    try:
        start, duration, samples = motion.start, motion.duration, motion.samples
    except Exception as error:
        raise ConfigError(f"trajectory: {type(motion).__name__}: {describe_fault(error)}") from error
    if fault := find_fault(start, shape):
        problems.append(f"its start is {fault}")
    if fault := find_fault(duration, ()):
        problems.append(f"its duration is {fault}")
    elif not duration > 0.0:
        problems.append(f"its duration is {duration!r}; it must be a time in s, above 0")
    if not isinstance(samples, int) or samples < 1:
        problems.append(f"its samples is {samples!r}; it must be a whole number of 1 or more")
    if problems:
        raise ConfigError(f"trajectory: {type(motion).__name__}: {problem}" for problem in problems)
    guarded.start, guarded.duration, guarded.samples = read_only(np.array(start, dtype=float)), duration, samples
    try:
        fault = _find_contradiction(guarded, "rad")
        problem = f"{place(motion.sample)} gave {fault}" if fault else None
    except Exception as error:
        problem = describe_fault(error)
    if problem:
        raise ConfigError(f"trajectory: {type(motion).__name__}: {problem}")
    return guarded


def _find_jump(motion: FloatArray, duration: float, unit: str) -> str | None:
    """Return a message about a position that jumps between evenly spaced samples, shape (T, 3, k); None without one.

    A motion whose velocity is zero everywhere is one of steps, which may jump.
    """
    period = duration / (len(motion) - 1)
    ways, fastest = np.linalg.norm(np.diff(motion[:, 0], axis=0), axis=1), np.linalg.norm(motion[:, 1], axis=1).max()
    longest = int(ways.argmax())
    if fastest == 0.0 or ways[longest] <= 3.0 * fastest * period + _CLOSE:
        return None
    return f"a position that jumps by {ways[longest]:.3g} {unit} near t = {(longest + 0.5) * period:.3g} s"


def _find_contradiction(guarded: Any, unit: str) -> str | None:
    """Return a message about a motion that does not begin at its start, or whose derivatives are those of another one.

    The derivatives are compared with central differences at some times. The median decides, as a motion may have
    corners. Accelerations that are zero everywhere are not compared.

    Args:
        guarded: The motion, with `start`, `duration` and `sample`.
        unit: Unit of its positions, for messages.
    """
    apart = 1e-4 * guarded.duration
    inner = guarded.duration * (np.arange(_PROBES) + 0.382) / _PROBES  # no multiple of a part of the duration
    motion = guarded.sample(np.concatenate([[0.0], inner - apart, inner, inner + apart]))
    beside = float(np.linalg.norm(motion[0, 0] - guarded.start))
    if beside > _CLOSE:
        return f"a position at t = 0 that is {beside:.3g} {unit} from its start {np.round(guarded.start, 4).tolist()}"
    before, there, after = np.split(motion[1:], 3)
    for order, (name, most) in enumerate(_DERIVATIVES, start=1):
        given, slope = there[:, order], (after[:, order - 1] - before[:, order - 1]) / (2.0 * apart)
        size = np.maximum(np.linalg.norm(given, axis=1), np.linalg.norm(slope, axis=1))
        moving = size > 1e-3 * size.max()
        if not moving.any() or (order == 2 and not given.any()):
            continue
        wrong = np.linalg.norm(given - slope, axis=1)[moving] / size[moving]
        if np.median(wrong) > most:
            of = "position" if order == 1 else "velocity"
            return f"a {name} that differs from the derivative of its {of} by {100.0 * np.median(wrong):.0f} % (median)"
    return None


class Trajectories(Registry[KindConfig, [FloatArray], Trajectory]):
    """Kinds of trajectories; `build` also takes the tip position at t = 0, shape (3,), in m."""

    def features(self, kind: str) -> TrajectoryFeatures:
        """Return the optional members of the module of a kind."""
        return read_features(TrajectoryFeatures, self.module(kind))

    def joint_motion(self, config: KindConfig, robot: "Robot") -> "JointMotion | None":
        """Return the joint motion of a kind, or None; see TrajectoryFeatures.

        Raises:
            ConfigError: if the config does not match the robot.
        """
        motion = self.ask(config, self.features(config.kind).joint_motion, robot)
        supplied = motion is not None and self.is_user_supplied(config.kind)
        return guard_joint_motion(motion, robot.home.shape) if supplied else motion


TRAJECTORIES = Trajectories(
    "trajectory",
    {
        "circle": "runner.trajectories.circle",
        "from_file": "runner.trajectories.from_file",
        "goal": "runner.trajectories.goal",
        "joint_quintic": "runner.trajectories.joint_quintic",
        "joint_sinusoids": "runner.trajectories.joint_sinusoids",
        "joint_waypoints": "runner.trajectories.joint_waypoints",
        "line": "runner.trajectories.line",
        "lissajous": "runner.trajectories.lissajous",
        "quintic": "runner.trajectories.quintic",
        "square": "runner.trajectories.square",
        "waypoints": "runner.trajectories.waypoints",
    },
    guard_trajectory,
)

__all__ = ["TRAJECTORIES", "Trajectory"]
