"""Desired motions of the tip."""

from runner.trajectories.kinds import Trajectories
from runner.trajectories.trajectory import Trajectory

TRAJECTORIES = Trajectories(
    {
        "circle": "runner.trajectories.circle",
        "goal": "runner.trajectories.goal",
        "line": "runner.trajectories.line",
        "lissajous": "runner.trajectories.lissajous",
        "quintic": "runner.trajectories.quintic",
        "square": "runner.trajectories.square",
        "waypoints": "runner.trajectories.waypoints",
    },
)

__all__ = ["TRAJECTORIES", "Trajectory"]
