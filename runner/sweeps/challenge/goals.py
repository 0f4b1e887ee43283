"""Other goals of a motion: the same distance from its start, within reach and away from singular configurations."""

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.dotted_keys import get
from runner.base.errors import ConfigError
from runner.robots.inverse_kinematics import solve_tip_position
from runner.robots.model import RobotModel
from runner.robots.task_space import task_basis

GOALS = 4
"""Number of other goals."""

_DIRECTIONS = 400
_REACH = 0.95  # of the arm's reach, within which the whole motion lies
_LEAST = 0.1  # of the reach: smallest singular value of the tip's Jacobian on the way
_WAYPOINTS = 7


def other_goals(config: RunConfig) -> list[FloatArray]:
    """Return up to GOALS other goals, far from each other and from the asked one, each of shape (3,), in m."""
    start, end = ends_of(config)
    model = config.arm.model
    offset = end - start
    length = float(np.linalg.norm(offset))
    if length == 0.0:
        return []
    directions = _directions(model) * length
    chosen: list[FloatArray] = [offset]
    left = list(range(len(directions)))
    while left and len(chosen) <= GOALS:
        distances = [min(float(np.linalg.norm(directions[place] - each)) for each in chosen) for place in left]
        place = left.pop(int(np.argmax(distances)))
        if _is_clear(model, config.arm.home, start, start + directions[place]):
            chosen.append(directions[place])
    return [start + each for each in chosen[1:]]


def ends_of(config: RunConfig) -> tuple[FloatArray, FloatArray]:
    """Return the tip's position at the start and at the goal of a motion that has one, each of shape (3,), in m."""
    goal = get(config.resolved, "trajectory.goal")
    return np.array(config.path.start, dtype=float), np.array(goal, dtype=float)


def _directions(model: RobotModel) -> FloatArray:
    """Return unit vectors in which the tip can move, evenly spread, shape (n, 3)."""
    basis = task_basis(model, pose=False)
    golden = np.pi * (3.0 - np.sqrt(5.0))
    steps = np.arange(_DIRECTIONS)
    if len(basis) == 2:
        angles = 2.0 * np.pi * steps / _DIRECTIONS
        own = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    elif len(basis) == 3:
        z = 1.0 - 2.0 * (steps + 0.5) / _DIRECTIONS
        radius = np.sqrt(1.0 - z * z)
        own = np.stack([radius * np.cos(golden * steps), radius * np.sin(golden * steps), z], axis=1)
    else:
        own = np.array([[1.0], [-1.0]])
    found: FloatArray = own @ basis
    return found


def _is_clear(model: RobotModel, home: FloatArray, start: FloatArray, goal: FloatArray) -> bool:
    """Return True if the straight way to a goal is within reach and away from singular configurations."""
    basis = task_basis(model, pose=False)
    points = start + np.linspace(0.0, 1.0, _WAYPOINTS)[1:, None] * (goal - start)
    if np.linalg.norm(points - model.shoulder, axis=1).max() > _REACH * model.reach:
        return False
    for point in points:
        try:
            q = solve_tip_position(model, point, home)
        except ConfigError:
            return False
        jacobian = basis @ model.tip_jacobian(q)[:3]
        if np.linalg.svd(jacobian, compute_uv=False)[-1] < _LEAST * model.reach:
            return False
    return True
