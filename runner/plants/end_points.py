"""Protocol of plants with end points that joint positions do not determine."""

from typing import Protocol, runtime_checkable

from runner.base.arrays import FloatArray


@runtime_checkable
class TellsEndPoints(Protocol):
    """A plant of ours whose stages end elsewhere than its joints tell, as its links bend."""

    def end_points(self) -> FloatArray:
        """Return the end point of each stage now, shape (stages, 3), in m; see runner.robots.robot.end_points."""
        ...

    def tip_motion(self) -> FloatArray:
        """Return position and velocity of the tip now, shape (2, 3), in m and m/s."""
        ...
