"""Trajectories: desired motions of the tip or of the joints."""

from runner.trajectories.kinds import Trajectories, guard_trajectory
from runner.trajectories.trajectory import Trajectory

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
