"""Watching the user's parts: they can change nothing that they are handed, and what goes wrong is told with its place.

A part of the user's gets copies that cannot be written to, and its answers are checked and copied. What it raises ends
the run as a failure that names file and line. Parts of this package are not watched.
"""

from runner.plugins.guard.belief import watch_belief
from runner.plugins.guard.controller import WatchedController, watch_loops
from runner.plugins.guard.environment import WatchedEnvironment, watch_environment
from runner.plugins.guard.metrics import watch_metrics
from runner.plugins.guard.plant import watch_plant
from runner.plugins.guard.read_only import read_only
from runner.plugins.guard.sensing import WatchedEncoders, WatchedTorqueSensors, WatchedWristSensor
from runner.plugins.guard.trajectory import WatchedTrajectory

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
