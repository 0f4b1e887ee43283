"""Feasibility of a path for joint-position controllers, checked on an ideal arm before a run."""

import copy
import math
from typing import cast

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, SimulationError
from runner.base.lazy_modules import pin
from runner.controllers import CONTROLLERS, ControllerConfig, Loop, PositionController
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.robots.task_space import task_basis
from runner.trajectories import Trajectory

_AT_LIMIT = 1e-6  # rad or m
_SINGULAR = 0.1  # of the reach; damping already pulls the tip off the path near a singular configuration


def check_path(
    controller: ControllerConfig, arm: Robot, trajectory: Trajectory, q_start: FloatArray, tolerance: float, end: float
) -> None:
    """Check that a joint-position controller can move an ideal arm along the path, without speed limits and noise.

    Args:
        controller: Config of the controller.
        arm: The robot.
        trajectory: The desired motion.
        q_start: Joint positions at t = 0, shape (nq,), in rad.
        tolerance: Largest allowed distance of the tip from the path, in m.
        end: Time at which the run ends, in s; the check ignores later parts of the path.

    Raises:
        ConfigError: if the arm cannot follow the path, with time, joint and reason; or if the path is too fast, with
            the shortest feasible time.
    """
    if not trajectory.tracked:
        return
    (loop,) = CONTROLLERS.build(controller, _without_speed_limits(arm))
    if trajectory.duration < loop.period:
        raise ConfigError(
            f"trajectory.duration: {trajectory.duration:g} s is shorter than one controller period, {loop.period:g} s"
        )
    lasts = min(trajectory.duration, max(end, loop.period))
    times: FloatArray = np.arange(math.floor(lasts / loop.period) + 1, dtype=np.float64) * loop.period
    try:
        q, stuck = _roll_out(loop, trajectory.sample(times), q_start)
    except SimulationError:  # of a user-supplied component: the run stops there and reports it
        return
    problem = (
        _find_end(times, q, stuck)
        or _find_stop(arm.model, trajectory, times, q, tolerance)
        or _check_speed(arm.model, trajectory, times, q)
        or _find_departure(arm.model, trajectory, times, q, tolerance)
    )
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


def _find_end(times: FloatArray, q: FloatArray, stuck: str) -> str:
    return f"trajectory: the arm cannot follow it beyond t = {times[len(q) - 1]:.4g} s: {stuck}" if stuck else ""


def _find_stop(model: RobotModel, trajectory: Trajectory, times: FloatArray, q: FloatArray, tolerance: float) -> str:
    """Return the joint limit or the singular configuration that keeps the tip from the path; "" for none."""
    lower, upper = model.position_limits
    outside = (q < lower - _AT_LIMIT) | (q > upper + _AT_LIMIT)
    if outside.any():
        row, joint = np.argwhere(outside)[0]
        return (
            f"trajectory: at t = {times[row]:.4g} s {model.joint_names[joint]} would be at {q[row, joint]:.4g} "
            f"{model.joint_units[joint]}; its limits are {lower[joint]:.4g} to {upper[joint]:.4g} "
            f"{model.joint_units[joint]}"
        )
    distance = trajectory.distance_to_path(model.tip_positions(q))
    if distance.max() <= tolerance:
        return ""
    row = int(np.argmax(distance > tolerance))
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
    return f"{_departure(times[row], distance)}: {' and '.join(reasons)}" if reasons else ""


def _find_departure(
    model: RobotModel, trajectory: Trajectory, times: FloatArray, q: FloatArray, tolerance: float
) -> str:
    distance = trajectory.distance_to_path(model.tip_positions(q))
    if distance.max() <= tolerance:
        return ""
    when = _departure(times[int(np.argmax(distance > tolerance))], distance)
    return f"{when}: no joint is at a limit; controller.period is too long for it, or controller.gain too low"


def _departure(time: float, distance: FloatArray) -> str:
    return f"trajectory: at t = {time:.4g} s the tip leaves the path, by {distance.max():.4g} m at most"


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
    free = copy.copy(robot.model)
    free.pin_model = pin.Model(robot.model.pin_model)
    free.pin_model.upperVelocityLimit = np.full(robot.model.nq, 1e30)
    return Robot(robot.urdf, free, robot.stages, robot.flange)
