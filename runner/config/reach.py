"""Reach check of the desired motion."""

import numpy as np

from runner.base.errors import ConfigError
from runner.config.joint_limits import check_joints
from runner.plugins.registry import KindConfig
from runner.robots.robot import Robot
from runner.robots.task_space import distance_beside
from runner.trajectories import Trajectory
from runner.trajectories.kinds import HasGoal, HasStart

_ROUNDING = 1e-12  # of the reach
_BESIDE = 1e-9  # of the reach: farther beside the plane of a planar arm a path cannot be reached
_SAMPLES = 1001


def check_points(arm: Robot, trajectory: KindConfig) -> None:
    """Check the start and the goal that a trajectory's config names, before there is a path.

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
        ConfigError: if it leads out of reach, beside what the joints of a planar arm can reach, or joints beyond their
            limits; says when.
    """
    check_joints(arm, path)
    model, times = arm.model, np.linspace(0.0, path.duration, _SAMPLES)
    points = path.sample(times)[:, 0]
    distance = np.linalg.norm(points - model.shoulder, axis=1)
    row = int(distance.argmax())
    if distance[row] > model.reach * (1.0 + _ROUNDING):
        raise ConfigError(
            [
                f"trajectory: at t = {times[row]:.4g} s the path lies {distance[row]:.4g} m from the shoulder, and the "
                f"arm reaches {model.reach:.4g} m: {distance[row] - model.reach:.4g} m too far; make it smaller, or "
                "start elsewhere"
            ]
        )
    beside = distance_beside(model, points)
    row = int(beside.argmax())
    if beside[row] > _BESIDE * model.reach:
        raise ConfigError(
            [
                f"trajectory: at t = {times[row]:.4g} s the path lies {beside[row]:.4g} m beside the plane or line in "
                "which alone the joints move the tip; take a path within it"
            ]
        )
