"""Runtime checks of plug-ins: read-only inputs, validated results, and errors with file and line.

A plug-in receives read-only copies, and its results are checked and copied. An exception in a plug-in ends the run as
a failure that names file and line. Except for write attempts, a fault in a metric plug-in only leaves its metrics
without values. Parts of this package are not checked.
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
