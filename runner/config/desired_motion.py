"""Desired motion: start configuration, and checks of reach, joint limits and period."""

from typing import Protocol, runtime_checkable

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.limits import SAMPLES
from runner.config.run import RunConfig
from runner.controllers import CONTROLLERS, ControllerConfig
from runner.plugins.registry import KindConfig
from runner.robots.inverse_kinematics import solve_tip_position
from runner.robots.robot import Robot, end_points
from runner.robots.task_space import distance_beside
from runner.trajectories import Trajectory
from runner.trajectories.joint_motion import TipOfJoints
from runner.trajectories.kinds import HasGoal, HasStart
from runner.trajectories.trajectory import joint_reference

_ROUNDING = 1e-12  # of the reach
_BESIDE = 1e-9  # of the reach: largest distance of a path from the plane of a planar arm
_SAMPLES = 1001


def check_points(arm: Robot, trajectory: KindConfig) -> None:
    """Check the start and the goal in a trajectory's config, before the path is built.

    Raises:
        ConfigError: if one of them is out of reach.
    """
    points = {
        "start": trajectory.start if isinstance(trajectory, HasStart) else None,
        "goal": trajectory.goal if isinstance(trajectory, HasGoal) else None,
    }
    problems = []
    for key, point in points.items():
        distance = 0.0 if point is None else float(np.linalg.norm(np.array(point) - arm.model.shoulder))
        if distance > arm.model.reach * (1.0 + _ROUNDING):
            problems.append(
                f"trajectory.{key}: {point} m is outside the workspace: {distance:.4g} m from the shoulder, and the "
                f"arm reaches {arm.model.reach:.4g} m"
            )
    if problems:
        raise ConfigError(problems)


def check_path(arm: Robot, path: Trajectory) -> None:
    """Check the whole path.

    Raises:
        ConfigError: if the path leaves the reach of the arm or the plane of a planar arm, or if joints exceed their
            limits; reports the time.
    """
    check_joints(arm, path)
    model, times = arm.model, np.linspace(0.0, path.duration, _SAMPLES)
    points = path.sample(times)[:, 0]
    distance = np.linalg.norm(points - model.shoulder, axis=1)
    row = int(distance.argmax())
    if distance[row] > model.reach * (1.0 + _ROUNDING):
        raise ConfigError(
            f"trajectory: at t = {times[row]:.4g} s the path lies {distance[row]:.4g} m from the shoulder, and the "
            f"arm reaches {model.reach:.4g} m: {distance[row] - model.reach:.4g} m too far; make it smaller, or "
            "start elsewhere"
        )
    beside = distance_beside(model, points)
    row = int(beside.argmax())
    if beside[row] > _BESIDE * model.reach:
        raise ConfigError(
            f"trajectory: at t = {times[row]:.4g} s the path lies {beside[row]:.4g} m outside the plane or line in "
            "which the joints can move the tip; take a path within it"
        )


_JOINT_SAMPLES = 4001
_ROUNDING_OF_LIMIT = 1e-9  # of a limit


def check_joints(arm: Robot, path: Trajectory) -> None:
    """Check positions and speeds of the joints if the desired motion is defined for the joints.

    Raises:
        ConfigError: if the motion needs too many samples. For each joint that exceeds a limit, it reports the largest
            excess: time, value and limit.
    """
    if not isinstance(path, TipOfJoints):
        return
    if excess := SAMPLES.excess(path.joints.samples):
        raise ConfigError(f"trajectory.duration: a motion of {path.duration:g} s {excess}; make it shorter or slower")
    times = np.linspace(0.0, path.duration, max(_JOINT_SAMPLES, path.joints.samples + 1))
    motion, model = path.sample_joints(times), arm.model
    lower, upper = model.position_limits
    limits = (
        ("position", "", motion[:, 0], lower, upper),
        ("speed", "/s", motion[:, 1], -model.velocity_limits, model.velocity_limits),
    )
    problems = []
    for what, per, values, least, most in limits:
        beyond = np.maximum(least - values, values - most)
        for joint in range(model.nq):
            row = int(beyond[:, joint].argmax())
            if beyond[row, joint] > _ROUNDING_OF_LIMIT * max(abs(least[joint]), abs(most[joint])):
                unit, low, high = f"{model.joint_units[joint]}{per}", least[joint], most[joint]
                problems.append(
                    f"trajectory: at t = {times[row]:.4g} s the {what} of {model.joint_names[joint]} is "
                    f"{values[row, joint]:.4g} {unit}, beyond its limits, {low:.4g} to {high:.4g} {unit}"
                )
    if problems:
        raise ConfigError(problems)


_TICKS = 4096  # of the motion in a run, at ticks
_SAME = 1e-6  # of the motion's extent: splines at rest at both ends repeat less well than that between rows
_REPEATING = (
    "allowed: trajectory=circle or lissajous with trajectory.easing=none, or trajectory=from_file with rows that "
    "repeat, controller.repeats_every their period and duration no longer than they last"
)


@runtime_checkable
class LearnsPeriods(Protocol):
    """Config of a controller that learns from one period of the desired motion to the next."""

    repeats_every: float
    period: float


def check_repeats(config: RunConfig) -> None:
    """Check that the desired motion repeats with the period of a learning controller.

    Raises:
        ConfigError: if the run ends before the learned torques act, or the motion differs a period later.
    """
    law, timing = config.controller, config.timing
    if not isinstance(law, LearnsPeriods):
        return
    every, end = law.repeats_every, timing.ticks * timing.tick
    late = round(every / timing.tick)
    if timing.ticks <= 2 * late:
        raise ConfigError(
            f"duration: {end:g} s is no longer than two of controller.repeats_every, {every:g} s; the first period "
            f"teaches nothing, and what the second teaches acts in the third; allowed: above {2.0 * every:g} s"
        )
    ticks = np.unique(np.linspace(0, timing.ticks - late, _TICKS).astype(int))
    now, then = (_positions(config, (ticks + shift) * timing.tick) for shift in (0, late))
    unlike = np.abs(then - now).max(axis=1)
    extent = float(np.ptp(np.concatenate([now, then]), axis=0).max())
    if extent > 0.0 and unlike.max() <= _SAME * extent:
        return
    what = _first_difference(config, ticks * timing.tick, unlike, _SAME * extent) if extent > 0.0 else "rests"
    raise ConfigError(f"controller.repeats_every: {every:g} s, but the desired motion {what}; {_REPEATING}")


def _first_difference(config: RunConfig, times: FloatArray, unlike: FloatArray, same: float) -> str:
    first, largest = int(np.argmax(unlike > same)), int(unlike.argmax())
    unit = "m" if joint_reference(config.path, times[:1]) is None else "rad"
    return (
        f"is not the same that time later: first at {times[first]:g} s, and by up to {unlike[largest]:.3g} "
        f"{unit} at {times[largest]:g} s"
    )


def _positions(config: RunConfig, times: FloatArray) -> FloatArray:
    """Return desired positions of the joints, or of the tip if the joints have none, shape (T, k)."""
    joints = joint_reference(config.path, times)
    motion = config.path.sample(times) if joints is None else joints
    return motion[:, 0]


def start_posture(
    controller: ControllerConfig, arm: Robot, start: FloatArray, ignore_base_rotation: bool
) -> FloatArray:
    """Return joint positions with the tip at a start, chosen by the controller.

    If the controller does not choose, the first stage moves and mounted stages stay at home.
    """
    try:
        wanted = CONTROLLERS.start_posture(controller, arm, start)
    except np.linalg.LinAlgError as error:
        raise ConfigError(f"trajectory.start: {error}") from error
    if wanted is not None:
        return np.array(wanted, dtype=np.float64)
    home = end_points(arm, arm.home[None], ignore_base_rotation)[:, 0]
    if np.array_equal(start, home[-1]):
        return arm.home
    if len(arm.stages) == 1 or not ignore_base_rotation:
        return solve_tip_position(arm.model, start, arm.home)
    first = arm.stages[0]
    return np.concatenate(
        [solve_tip_position(first.model, start - (home[-1] - home[0]), first.home), arm.home[first.joints.stop :]]
    )
