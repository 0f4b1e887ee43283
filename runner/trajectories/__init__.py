"""Desired motions of the tip."""

from runner.registry import Registry
from runner.trajectories.trajectory import Trajectory

TRAJECTORIES = Registry("trajectory", {"goal": "runner.trajectories.goal", "quintic": "runner.trajectories.quintic"})

__all__ = ["TRAJECTORIES", "Trajectory"]
