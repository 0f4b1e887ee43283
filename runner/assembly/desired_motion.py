"""Desired motion: start configuration, and checks of reach, joint limits, period and feasibility."""

import math
from dataclasses import replace
from typing import Protocol, cast, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, SimulationError
from runner.base.limits import SAMPLES
from runner.controllers import CONTROLLERS, ControllerConfig, Loop, PositionController
from runner.plugins.registry import KindConfig
from runner.robots.inverse_kinematics import solve_tip_position
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, end_points
from runner.robots.task_space import distance_beside, task_basis
from runner.trajectories import HasGoal, HasStart, Trajectory
from runner.trajectories.joint_motion import TipOfJoints

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
    unit = "m" if config.path.sample_joints(times[:1]) is None else "rad"
    return (
        f"is not the same that time later: first at {times[first]:g} s, and by up to {unlike[largest]:.3g} "
        f"{unit} at {times[largest]:g} s"
    )


def _positions(config: RunConfig, times: FloatArray) -> FloatArray:
    """Return desired positions of the joints, or of the tip if the joints have none, shape (T, k)."""
    joints = config.path.sample_joints(times)
    motion = config.path.sample(times) if joints is None else joints
    return motion[:, 0]


def find_start(controller: ControllerConfig, arm: Robot, path: Trajectory, ignore_base_rotation: bool) -> FloatArray:
    """Return the initial joint positions, shape (nq,), in rad: those of a joint motion, or those of its controller.

    If the controller does not choose, the first stage moves and mounted stages stay at home.

    Raises:
        ConfigError: if the arm cannot reach the start of the path.
    """
    if isinstance(path, TipOfJoints):
        return path.q_start
    start = path.start
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


_AT_LIMIT = 1e-6  # rad or m
_SINGULAR = 0.1  # of the reach; damping already pulls the tip off the path near a singular configuration


def check_feasible(config: RunConfig, q_start: FloatArray) -> None:
    """Check that a joint-position controller can move an ideal arm along the path, without speed limits and noise.

    The tip may leave the path by `robot.settling_band`. Parts of the path after the end of the run are not checked.

    Args:
        config: The checked config.
        q_start: Joint positions at t = 0, shape (nq,), in rad.

    Raises:
        ConfigError: if the arm cannot follow the path, with time, joint and reason; or if the path is too fast, with
            the shortest feasible time.
    """
    arm, trajectory, tolerance = config.arm, config.path, config.robot.settling_band
    if not (trajectory.tracked and CONTROLLERS.features(config.controller.kind).FOLLOWS_PATHS):
        return
    (loop,) = CONTROLLERS.build(config.controller, _without_speed_limits(arm))
    if trajectory.duration < loop.period:
        raise ConfigError(
            f"trajectory.duration: {trajectory.duration:g} s is shorter than one controller period, {loop.period:g} s"
        )
    end = config.timing.ticks * config.timing.tick
    lasts = min(trajectory.duration, max(end, loop.period))
    times: FloatArray = np.arange(math.floor(lasts / loop.period) + 1, dtype=np.float64) * loop.period
    try:
        q, stuck = _roll_out(loop, trajectory.sample(times), q_start)
    except SimulationError:  # of a user-supplied component: the run stops there and reports it
        return
    if stuck:
        raise ConfigError(f"trajectory: the arm cannot follow it beyond t = {times[len(q) - 1]:.4g} s: {stuck}")
    distance = trajectory.distance_to_path(arm.model.tip_positions(q))
    far = np.flatnonzero(~(distance <= tolerance))
    left = f"the tip leaves the path, by {distance.max():.4g} m at most"
    problem = _find_stop(arm.model, times, q, far, left) or _check_speed(arm.model, trajectory, times, q)
    if not problem and len(far):
        why = "no joint is at a limit; controller.period is too long for it, or controller.gain too low"
        problem = f"trajectory: at t = {times[far[0]]:.4g} s {left}: {why}"
    if problem:
        raise ConfigError(problem)


def _roll_out(loop: Loop, desired: FloatArray, q_start: FloatArray) -> tuple[FloatArray, str]:
    """Return the joint positions reached, a row for each time, and why the law stopped before the end, or ""."""
    law, q = cast(PositionController, loop.controller), q_start
    law.reset(q)
    rows = [q]
    for k, reference in enumerate(desired[:-1]):
        try:
            q = law.joint_positions(k * loop.period, q, np.zeros_like(q), reference).copy()
        except np.linalg.LinAlgError as error:
            return np.array(rows), str(error)
        rows.append(q)
    return np.array(rows), ""


def _find_stop(model: RobotModel, times: FloatArray, q: FloatArray, far: NDArray[np.intp], left: str) -> str:
    """Return the joint limit or the singular configuration that keeps the tip from the path; "" for none.

    Args:
        model: The arm.
        times: Times, shape (T,), in s.
        q: Joint positions at these times, shape (T, nq), in rad.
        far: Indices of the times at which the tip is too far from the path.
        left: How far the tip leaves the path.
    """
    lower, upper = model.position_limits
    outside = (q < lower - _AT_LIMIT) | (q > upper + _AT_LIMIT)
    if outside.any():
        row, joint = np.argwhere(outside)[0]
        return (
            f"trajectory: at t = {times[row]:.4g} s {model.joint_names[joint]} would be at {q[row, joint]:.4g} "
            f"{model.joint_units[joint]}; its limits are {lower[joint]:.4g} to {upper[joint]:.4g} "
            f"{model.joint_units[joint]}"
        )
    if not len(far):
        return ""
    row = far[0]
    reasons = [
        f"{name} stands at its limit of {limit:.4g} {unit}"
        for name, unit, *limits, value in zip(model.joint_names, model.joint_units, lower, upper, q[row], strict=True)
        for limit in limits
        if abs(value - limit) < _AT_LIMIT
    ]
    J = task_basis(model, pose=False) @ model.tip_jacobian(q[row])[:3]
    smallest = float(np.linalg.svd(J, compute_uv=False)[-1])
    if smallest < _SINGULAR * model.reach:
        reasons.append(
            f"the posture is singular, or nearly so (smallest singular value {smallest:.3g} m; reach "
            f"{model.reach:.4g} m)"
        )
    return f"trajectory: at t = {times[row]:.4g} s {left}: {' and '.join(reasons)}" if reasons else ""


def _check_speed(model: RobotModel, trajectory: Trajectory, times: FloatArray, q: FloatArray) -> str:
    speeds = np.abs(np.diff(q, axis=0)) / (times[1] - times[0])
    share = speeds / model.velocity_limits
    if share.max(initial=0.0) <= 1.0 + 1e-9:
        return ""
    row, joint = np.unravel_index(int(np.argmax(share)), share.shape)
    name, speed, limit = model.joint_names[joint], speeds[row, joint], model.velocity_limits[joint]
    unit, moves = model.joint_units[joint], "slide" if model.prismatic[joint] else "turn"
    return (
        f"trajectory.duration: {trajectory.duration:g} s is too fast: at t = {times[row]:.4g} s {name} would {moves} "
        f"at {speed:.4g} {unit}/s, and its limit is {limit:.4g} {unit}/s; the shortest feasible time is "
        f"{trajectory.duration * share.max():.4g} s"
    )


def _without_speed_limits(robot: Robot) -> Robot:
    free = np.full(robot.model.nq, 1e30)
    model = robot.model.with_change(lambda own: setattr(own, "upperVelocityLimit", free))
    return replace(robot, model=model)
