"""Watching the user's parts: they can change nothing that they are handed, and what goes wrong is told with its place.

A part of the user's gets copies that cannot be written to, and its answers are checked and copied. What it raises ends
the run as a failure that names file and line. Parts of this package are not watched.
"""

from runner.guard.belief import watch_belief
from runner.guard.controller import WatchedController, watch_loops
from runner.guard.environment import WatchedEnvironment, watch_environment
from runner.guard.metrics import watch_metrics
from runner.guard.plant import watch_plant
from runner.guard.read_only import read_only
from runner.guard.sensing import WatchedEncoders, WatchedTorqueSensors, WatchedWristSensor
from runner.guard.trajectory import WatchedTrajectory

__all__ = [
    "WatchedController",
    "WatchedEncoders",
    "WatchedEnvironment",
    "WatchedTorqueSensors",
    "WatchedTrajectory",
    "WatchedWristSensor",
    "read_only",
    "watch_belief",
    "watch_environment",
    "watch_loops",
    "watch_metrics",
    "watch_plant",
]
