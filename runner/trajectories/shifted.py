"""Desired motion with a constant position offset."""

from dataclasses import dataclass

from runner.base.arrays import FloatArray
from runner.trajectories.trajectory import Trajectory


@dataclass(frozen=True)
class Shifted:
    """A desired motion less a constant offset; see Trajectory.

    Attributes:
        motion: The motion.
        offset: What is subtracted from its positions, shape (3,), in m.
    """

    motion: Trajectory
    offset: FloatArray

    @property
    def start(self) -> FloatArray:
        """Start of the motion, shifted."""
        return self.motion.start - self.offset

    @property
    def goal(self) -> FloatArray | None:
        """Goal of the motion, shifted."""
        return None if self.motion.goal is None else self.motion.goal - self.offset

    @property
    def duration(self) -> float:
        """Time of the motion, in s."""
        return self.motion.duration

    @property
    def run_duration(self) -> float:
        """Time of a run, in s."""
        return self.motion.run_duration

    @property
    def tracked(self) -> bool:
        """Whether there is a motion to track."""
        return self.motion.tracked

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion, shifted."""
        motion = self.motion.sample(times)
        motion[:, 0] -= self.offset
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the shifted path."""
        return self.motion.distance_to_path(points + self.offset)
