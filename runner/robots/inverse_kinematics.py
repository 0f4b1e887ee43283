"""Joint positions for a tip position or a tip pose, on the branch that holds the home posture."""

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np
import pinocchio as pin

from runner.errors import ConfigError
from runner.robots.model import FloatArray, RobotModel
from runner.robots.task_space import task_directions

TOLERANCE = 1e-12  # m; Newton's last step squares it, so that an arm starts at its trajectory's start to rounding
_STEPS = 200  # way-points from home to the target; each needs a few Newton steps
_MAX_NEWTON = 60
_REACHED = 1e-9  # m, or rad
_SEARCHES = 40  # random postures tried where no way leads from home

# Error of the tip at joint positions, and the Jacobian of its velocity: shapes (k,) and (k, nq).
Task = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def solve_tip_position(model: RobotModel, target: FloatArray, home: FloatArray) -> FloatArray:
    """Return joint positions that bring the tip to a target, on the branch of the home posture.

    The tip is led from home to the target by Newton steps from way-point to way-point: along the straight line, or,
    where that passes a singular posture and leaves the branch, around the shoulder. A branch is known by the sign of
    det J, which only a singular posture changes. An arm with more joints than it needs moves them as little as it can,
    and one whose tip stays in a plane is asked for the target's place in that plane. Where joint limits bar both ways,
    other branches are searched.

    Args:
        model: The robot.
        target: Tip position in the base frame, shape (3,), in m.
        home: Joint positions at home, shape (nq,), in rad.

    Returns:
        Joint positions within the limits, shape (nq,), in rad; `home` itself when the target is the home tip.

    Raises:
        ConfigError: if no joint positions are found; gives the distance that is left at the nearest found.
    """
    start = model.tip_position(np.asarray(home, dtype=float))
    if np.array_equal(start, target):
        return np.array(home, dtype=float)
    paths = (_straight(start, target), _around(model.shoulder, start, target))
    directions = task_directions(model, pose=False)
    branch, found, reached = _branch(model, home), [], []
    for path in paths:
        q = _follow(model, (_position_task(model, point, directions) for point in path), home)
        found.append(q)
        if float(np.linalg.norm(model.tip_position(q) - target)) <= _REACHED:
            if _branch(model, q) == branch:
                return q
            reached.append(q)
    if reached:
        return reached[0]
    task = _position_task(model, target, directions)
    q = _search(model, task, [np.array(home, dtype=float), *found])
    distance = float(np.linalg.norm(target - model.tip_position(q)))
    if distance <= _REACHED:
        return q
    raise ConfigError(
        [
            f"trajectory.start: no posture found that brings the tip to {np.round(target, 6).tolist()} m; "
            f"{distance:.3g} m are left{_where(model, target, q)}. Choose another start"
        ]
    )


def solve_tip_pose(model: RobotModel, pose: FloatArray, home: FloatArray) -> FloatArray:
    """Return joint positions that bring the tip to a position and an orientation, on the branch of the home posture.

    The tip is led from home to the pose by Newton steps from way-point to way-point, along the straight line and the
    shortest turn (the logarithm of the rotation that is left, which has no singular orientation below half a turn).
    Where a joint limit or a singular posture bars that way, other branches are searched.

    Args:
        model: The robot.
        pose: The tip's homogeneous transform in the base frame, shape (4, 4).
        home: Joint positions at home, shape (nq,), in rad.

    Returns:
        Joint positions within the limits, shape (nq,), in rad; `home` itself when the pose is that of the home tip.

    Raises:
        ConfigError: if no joint positions are found; gives the distance and the angle left at the nearest found.
    """
    start = model.tip_pose(np.asarray(home, dtype=float))
    if np.array_equal(start, pose):
        return np.array(home, dtype=float)
    turn = pin.log3(start[:3, :3].T @ pose[:3, :3])
    points = _straight(start[:3, 3], pose[:3, 3])
    turned = [start[:3, :3] @ pin.exp3(turn * (step + 1) / _STEPS) for step in range(_STEPS - 1)] + [pose[:3, :3]]
    directions = task_directions(model, pose=True)
    q = _follow(model, (_pose_task(model, p, R, directions) for p, R in zip(points, turned, strict=True)), home)
    task = _pose_task(model, pose[:3, 3], pose[:3, :3], directions)
    if np.linalg.norm(task(q)[0]) > _REACHED:
        q = _search(model, task, [np.array(home, dtype=float), q])
    error = _pose_error(model, q, pose[:3, 3], pose[:3, :3])
    if np.linalg.norm(error) <= _REACHED:
        return q
    turn = pin.log3(pose[:3, :3])
    raise ConfigError(
        [
            f"trajectory.start: no posture found that brings the tip to {np.round(pose[:3, 3], 6).tolist()} m with "
            f"the rotation vector {np.round(turn, 4).tolist()} rad; {np.linalg.norm(error[:3]):.3g} m and "
            f"{np.linalg.norm(error[3:]):.3g} rad are left{_where(model, pose[:3, 3], q)}. Choose another start"
        ]
    )


def _position_task(model: RobotModel, target: FloatArray, directions: FloatArray) -> Task:
    def task(q: FloatArray) -> tuple[FloatArray, FloatArray]:
        return directions @ (target - model.tip_position(q)), directions @ model.tip_jacobian(q)[:3]

    return task


def _pose_task(model: RobotModel, position: FloatArray, rotation: FloatArray, directions: FloatArray) -> Task:
    def task(q: FloatArray) -> tuple[FloatArray, FloatArray]:
        return directions @ _pose_error(model, q, position, rotation), directions @ model.tip_jacobian(q)

    return task


def _pose_error(model: RobotModel, q: FloatArray, position: FloatArray, rotation: FloatArray) -> FloatArray:
    pose = model.tip_pose(q)
    turn = pin.log3(rotation @ pose[:3, :3].T)  # of the base frame's axes, as the Jacobian's angular rows
    return np.concatenate([position - pose[:3, 3], turn])


def _branch(model: RobotModel, q: FloatArray) -> float:
    """Return the sign of det J; zero for an arm whose Jacobian of the tip position is not square."""
    J = model.tip_jacobian(q)[:3]
    return float(np.sign(np.linalg.det(J))) if J.shape == (3, 3) else 0.0


def _follow(model: RobotModel, tasks: Iterable[Task], home: FloatArray) -> FloatArray:
    q, limits = np.array(home, dtype=float), model.position_limits
    for task in tasks:
        q = _newton(task, q, limits)
    return q


def _straight(start: FloatArray, target: FloatArray) -> FloatArray:
    """Return way-points on a straight line, shape (N, 3)."""
    share = np.linspace(0.0, 1.0, _STEPS + 1)[1:, None]
    points: FloatArray = (1.0 - share) * start + share * target
    points[-1] = target
    return points


def _around(centre: FloatArray, start: FloatArray, target: FloatArray) -> FloatArray:
    """Return way-points straight in radius and direction about a centre, shape (N, 3)."""
    straight = _straight(start, target) - centre
    share = np.linspace(0.0, 1.0, _STEPS + 1)[1:]
    radius = (1.0 - share) * np.linalg.norm(start - centre) + share * np.linalg.norm(target - centre)
    norm = np.linalg.norm(straight, axis=1)
    points: FloatArray = centre + straight * (radius / np.maximum(norm, 1e-6 * np.maximum(radius, 1e-12)))[:, None]
    points[-1] = target
    return points


def _newton(task: Task, q: FloatArray, limits: FloatArray) -> FloatArray:
    lower, upper = limits
    for _ in range(_MAX_NEWTON):
        error, J = task(q)
        left = float(error @ error)
        if math.sqrt(left) < TOLERANCE:
            break
        # The damping vanishes with the error: Newton's speed near the solution, no leaps near a singular posture.
        damping = 1e-3 * left * np.eye(len(error))
        step = J.T @ np.linalg.solve(J @ J.T + damping, error)
        moved = q + step
        if ((moved >= lower) & (moved <= upper)).all():
            q = moved
            continue
        blocked = np.zeros(len(q), dtype=bool)
        while (outside := ~blocked & ((q + step < lower) | (q + step > upper))).any():
            blocked |= outside  # these joints stop at their limits, and the others do without them
            held = np.clip(q + step, lower, upper) - q
            free = np.where(blocked, 0.0, J)
            rest = error - J @ np.where(blocked, held, 0.0)
            step = np.where(blocked, held, free.T @ np.linalg.lstsq(free @ free.T + damping, rest, rcond=None)[0])
        q = q + step
    return q


def _search(model: RobotModel, task: Task, guesses: Sequence[FloatArray]) -> FloatArray:
    """Return the joint positions within the limits that leave the least error, sought from guesses and at random."""
    from scipy.optimize import least_squares  # takes longer to import than most arms to find their posture

    lower, upper = model.position_limits
    least_usual, most_usual = model.usual_range
    postures = np.random.default_rng(0).uniform(least_usual, most_usual, (_SEARCHES, model.nq))
    best, least = guesses[0], np.inf
    for guess in (*guesses, *postures):
        inside = np.clip(guess, lower + 1e-9, upper - 1e-9)
        found = least_squares(lambda q: task(q)[0], inside, jac=lambda q: -task(q)[1], bounds=(lower, upper))
        q = _newton(task, found.x, model.position_limits) if found.cost < 1e-6 else found.x
        error = float(np.linalg.norm(task(q)[0]))
        if error <= _REACHED:
            return q
        if error < 0.999 * least:  # the first of equally good ones: a later one may have turned without use
            best, least = q, error
    return best


def _where(model: RobotModel, target: FloatArray, nearest: FloatArray) -> str:
    """Return how far a target and the nearest tip position lie from the shoulder, and the joints that hold it back."""
    there, here = (float(np.linalg.norm(point - model.shoulder)) for point in (target, model.tip_position(nearest)))
    text = f"; it lies {there:.4g} m from the shoulder, the nearest found {here:.4g} m"
    margins = model.limit_margins(nearest)
    stopped = [name for name, margin in zip(model.joint_names, margins, strict=True) if margin < 1e-4]
    return text + (f", {', '.join(stopped)} at a limit" if stopped else "")
