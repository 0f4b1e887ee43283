"""Desired motions of the tip."""

from runner.guard import WatchedTrajectory
from runner.registry import Registry
from runner.trajectories.trajectory import Trajectory

TRAJECTORIES = Registry(
    "trajectory",
    {
        "circle": "runner.trajectories.circle",
        "goal": "runner.trajectories.goal",
        "line": "runner.trajectories.line",
        "lissajous": "runner.trajectories.lissajous",
        "quintic": "runner.trajectories.quintic",
        "square": "runner.trajectories.square",
        "waypoints": "runner.trajectories.waypoints",
    },
    watch=WatchedTrajectory,
)

__all__ = ["TRAJECTORIES", "Trajectory"]
