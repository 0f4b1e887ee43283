"""What the config of a trajectory may offer, and the registry of trajectories."""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

from runner.guard import WatchedTrajectory
from runner.registry import KindConfig, Registry
from runner.trajectories.trajectory import FloatArray, Trajectory


@runtime_checkable
class HasStart(Protocol):
    """A config of trajectories that may say where they start; else they do where the tip is at home."""

    start: list[float] | None
    """Tip position at t = 0, in m; None is the tip at home."""


@runtime_checkable
class HasGoal(Protocol):
    """A config of trajectories that end at a point, which must be within reach."""

    goal: list[float] | None
    """Tip position at the end, in m."""


class Trajectories(Registry[KindConfig, [FloatArray], Trajectory]):
    """The kinds of trajectories; `build` gives each the tip position at t = 0, shape (3,), in m."""

    def __init__(self, modules: Mapping[str, str]) -> None:
        super().__init__("trajectory", modules, WatchedTrajectory)
