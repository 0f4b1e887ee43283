"""Inverse kinematics of the tip position or pose, on the branch of the home configuration."""

import math
from collections.abc import Callable, Iterable, Sequence
from functools import wraps

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.base.portable import dot, solve_symmetric
from runner.robots.model import RobotModel
from runner.robots.task_space import task_basis

TOLERANCE = 1e-12  # m; Newton's last step squares the error, so that the arm starts on its trajectory to rounding
_STEPS = 200  # way-points from home to the target; each needs a few Newton steps
_MAX_NEWTON = 60
_REACHED = 1e-9  # m, or rad
_SEARCHES = 40  # random start configurations if no path from home reaches the target
_KEPT = 1024  # solutions in the cache of a process

# Error of the tip at joint positions, and the Jacobian of its velocity: shapes (k,) and (k, nq).
Task = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
Solve = Callable[[RobotModel, FloatArray, FloatArray], FloatArray]


def _once(solve: Solve) -> Solve:
    """Return a solver with a cache, because the runs of a sweep need the same solution."""
    found: dict[tuple[bytes, ...], FloatArray] = {}

    @wraps(solve)
    def once(model: RobotModel, wanted: FloatArray, home: FloatArray) -> FloatArray:
        key = model.kinematics, *(np.asarray(part, dtype=float).tobytes() for part in (wanted, home))
        if key not in found:
            if len(found) >= _KEPT:
                found.pop(next(iter(found)))
            found[key] = solve(model, wanted, home)
        return found[key].copy()

    return once


@_once
def solve_tip_position(model: RobotModel, target: FloatArray, home: FloatArray) -> FloatArray:
    """Return joint positions for a tip position, on the branch of the home configuration.

    Newton steps move the tip from home to the target through way-points along the straight line. If this line passes a
    singular configuration and leaves the branch, the path around the shoulder is used. The sign of det J identifies a
    branch, because it changes in singular configurations only. A redundant arm moves its joints as little as possible.
    For an arm whose tip stays in a plane, the target is projected on this plane. If joint limits block both paths,
    other branches are searched.

    Args:
        model: The robot.
        target: Tip position in the base frame, shape (3,), in m.
        home: Joint positions at home, shape (nq,), in rad.

    Returns:
        Joint positions within the limits, shape (nq,), in rad; `home` itself if the target is the tip at home.

    Raises:
        ConfigError: if no joint positions are found; the message contains the smallest remaining distance.
    """
    start = model.tip_position(np.asarray(home, dtype=float))
    if np.array_equal(start, target):
        return np.array(home, dtype=float)
    paths = (_straight(start, target), _around(model.shoulder, start, target))
    directions = task_basis(model, pose=False)
    branch, found, reached, tip = _branch(model, home), [], [], _Tip(model)
    for path in paths:
        q = _follow(model, (_position_task(tip, point, directions) for point in path), home)
        found.append(q)
        if float(np.linalg.norm(model.tip_position(q) - target)) <= _REACHED:
            if _branch(model, q) == branch:
                return q
            reached.append(q)
    if reached:
        return reached[0]
    task = _position_task(tip, target, directions)
    q = _search(model, task, [np.array(home, dtype=float), *found])
    distance = float(np.linalg.norm(target - model.tip_position(q)))
    if distance <= _REACHED:
        return q
    raise ConfigError(
        f"trajectory.start: no posture found that brings the tip to {np.round(target, 6).tolist()} m; "
        f"{distance:.3g} m are left{_where(model, target, q)}. Choose another start"
    )


@_once
def solve_tip_pose(model: RobotModel, pose: FloatArray, home: FloatArray) -> FloatArray:
    """Return joint positions for a tip position and orientation, on the branch of the home configuration.

    Newton steps move the tip from home to the pose through way-points along the straight line and the shortest
    rotation (the logarithm of the remaining rotation, which has no singularity below half a turn). If a joint limit or
    a singular configuration blocks this path, other branches are searched.

    Args:
        model: The robot.
        pose: The tip's homogeneous transform in the base frame, shape (4, 4).
        home: Joint positions at home, shape (nq,), in rad.

    Returns:
        Joint positions within the limits, shape (nq,), in rad; `home` itself if the pose is that of the tip at home.

    Raises:
        ConfigError: if no joint positions are found; the message contains the smallest remaining distance and angle.
    """
    start = model.tip_pose(np.asarray(home, dtype=float))
    if np.array_equal(start, pose):
        return np.array(home, dtype=float)
    turn = pin.log3(start[:3, :3].T @ pose[:3, :3])
    points = _straight(start[:3, 3], pose[:3, 3])
    turned = [start[:3, :3] @ pin.exp3(turn * (step + 1) / _STEPS) for step in range(_STEPS - 1)] + [pose[:3, :3]]
    directions, tip = task_basis(model, pose=True), _Tip(model)
    q = _follow(model, (_pose_task(tip, p, R, directions) for p, R in zip(points, turned, strict=True)), home)
    task = _pose_task(tip, pose[:3, 3], pose[:3, :3], directions)
    if np.linalg.norm(task(q)[0]) > _REACHED:
        q = _search(model, task, [np.array(home, dtype=float), q])
    error = _pose_error(*tip.at(q)[:2], pose[:3, 3], pose[:3, :3])
    if np.linalg.norm(error) <= _REACHED:
        return q
    turn = pin.log3(pose[:3, :3])
    raise ConfigError(
        f"trajectory.start: no posture found that brings the tip to {np.round(pose[:3, 3], 6).tolist()} m with "
        f"the rotation vector {np.round(turn, 4).tolist()} rad; {np.linalg.norm(error[:3]):.3g} m and "
        f"{np.linalg.norm(error[3:]):.3g} rad are left{_where(model, pose[:3, 3], q)}. Choose another start"
    )


class _Tip:
    """Tip of an arm at joint positions, with a cache of the last ones, which must not be changed."""

    def __init__(self, model: RobotModel) -> None:
        self._model, self._data, self._frame = model.pin_model, model.pin_model.createData(), model.tip_frame
        placement = self._data.oMf[self._frame]
        self._x: FloatArray = placement.translation  # views that each update refreshes
        self._R: FloatArray = placement.rotation
        self._q: FloatArray | None = None
        self._J: FloatArray = np.empty(0)

    def at(self, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return position, rotation and Jacobian in the base frame, shapes (3,), (3, 3) and (6, nq)."""
        if q is not self._q:
            model, data, frame = self._model, self._data, self._frame
            pin.computeJointJacobians(model, data, q)
            pin.updateFramePlacement(model, data, frame)
            self._q, self._J = q, pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
        return self._x, self._R, self._J


def _position_task(tip: _Tip, target: FloatArray, directions: FloatArray) -> Task:
    everywhere = len(directions) == 3  # the product with them has no effect

    def task(q: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, _, J = tip.at(q)
        return (target - x, J[:3]) if everywhere else (directions @ (target - x), directions @ J[:3])

    return task


def _pose_task(tip: _Tip, position: FloatArray, rotation: FloatArray, directions: FloatArray) -> Task:
    everywhere = len(directions) == 6

    def task(q: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, R, J = tip.at(q)
        error = _pose_error(x, R, position, rotation)
        return (error, J) if everywhere else (directions @ error, directions @ J)

    return task


def _pose_error(x: FloatArray, R: FloatArray, position: FloatArray, rotation: FloatArray) -> FloatArray:
    turn = pin.log3(rotation.dot(R.T))  # along the axes of the base frame, as the angular rows of the Jacobian
    return np.concatenate([position - x, turn])


def _branch(model: RobotModel, q: FloatArray) -> float:
    """Return the sign of det J; zero if the Jacobian of the tip position is not square."""
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
    """Return way-points with linear radius about a centre, in the directions of a straight line, shape (N, 3)."""
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
        left = float(dot(error, error))
        if math.sqrt(left) < TOLERANCE:
            break
        # The damping vanishes with the error: fast convergence, and no large steps near a singular configuration.
        square, added = J.dot(J.T), 1e-3 * left
        square.flat[:: len(error) + 1] += added
        step = dot(J.T, solve_symmetric(square, error, "the tip's Jacobian is singular"))
        moved = q + step
        if np.minimum(moved - lower, upper - moved).min() >= 0.0:
            q = moved
            continue
        damping = added * np.eye(len(error))
        blocked = np.zeros(len(q), dtype=bool)
        while (outside := ~blocked & ((q + step < lower) | (q + step > upper))).any():
            blocked |= outside  # these joints stop at their limits, and only the others move
            held = np.clip(q + step, lower, upper) - q
            free = np.where(blocked, 0.0, J)
            rest = error - dot(J, np.where(blocked, held, 0.0))
            step = np.where(blocked, held, dot(free.T, solve_symmetric(free @ free.T + damping, rest)))
        q = q + step
    return q


def _search(model: RobotModel, task: Task, guesses: Sequence[FloatArray]) -> FloatArray:
    """Return the joint positions within the limits with the smallest error, from guesses and random starts."""
    from scipy.optimize import least_squares  # the import takes longer than most solutions

    lower, upper = model.position_limits
    least_usual, most_usual = model.usual_range
    postures = np.random.default_rng(0).uniform(least_usual, most_usual, (_SEARCHES, model.nq))
    best, least = guesses[0], np.inf
    for guess in (*guesses, *postures):
        inside = np.clip(guess, lower + 1e-9, upper - 1e-9)
        found = least_squares(
            lambda q: task(q.copy())[0], inside, jac=lambda q: -task(q.copy())[1], bounds=(lower, upper)
        )
        q = _newton(task, found.x, model.position_limits) if found.cost < 1e-6 else found.x
        error = float(np.linalg.norm(task(q)[0]))
        if error <= _REACHED:
            return q
        if error < 0.999 * least:  # the first of equally good ones, because a later one may have useless turns
            best, least = q, error
    return best


def _where(model: RobotModel, target: FloatArray, nearest: FloatArray) -> str:
    """Return a message with the distances of target and nearest tip from the shoulder, and the joints at limits."""
    there, here = (float(np.linalg.norm(point - model.shoulder)) for point in (target, model.tip_position(nearest)))
    text = f"; it lies {there:.4g} m from the shoulder, the nearest found {here:.4g} m"
    margins = model.limit_margins(nearest)
    stopped = [name for name, margin in zip(model.joint_names, margins, strict=True) if margin < 1e-4]
    return text + (f", {', '.join(stopped)} at a limit" if stopped else "")
