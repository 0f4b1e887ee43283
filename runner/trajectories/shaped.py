"""Motions derived from another: input-shaped against vibration of flexible arms, or with an offset."""

from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING, cast

import numpy as np

from runner.base.arrays import FloatArray
from runner.trajectories.impulses import Impulses
from runner.trajectories.trajectory import OfTip, Trajectory

if TYPE_CHECKING:  # readers of stored runs use Shifted and do not need the simulator
    from runner.trajectories.joint_motion import JointMotion


@dataclass(frozen=True)
class DerivedMotion(OfTip):
    """Desired motion of the tip derived from another one, whose properties are the defaults; see Trajectory.

    Attributes:
        motion: The original motion.
    """

    motion: Trajectory

    @property
    def start(self) -> FloatArray:
        """Start of the original motion."""
        return self.motion.start

    @property
    def goal(self) -> FloatArray | None:
        """Goal of the original motion."""
        return self.motion.goal

    @property
    def duration(self) -> float:
        """Duration of the original motion, in s."""
        return self.motion.duration

    @property
    def run_duration(self) -> float:
        """Default duration of a run, in s."""
        return self.motion.run_duration

    @property
    def tracked(self) -> bool:
        """True if the original motion is tracked."""
        return self.motion.tracked


@dataclass(frozen=True)
class Shaped(DerivedMotion):
    r"""Desired motion of the tip or of the joints, convolved with impulses; see Trajectory for the attributes.

    .. math:: x_s(t) = \sum_i A_i x(t - t_i)

    The same sum gives velocity and acceleration. The times t_i are exact, not rounded to ticks, and x(t) for t < 0 is
    the start at rest. The path is that of the original motion; a shaped motion deviates from a curved path.

    Attributes:
        motion: The original motion, which ends at rest.
        impulses: The impulses.
    """

    impulses: Impulses

    @property
    def duration(self) -> float:
        """Duration of the original motion plus the delay of the last impulse, in s."""
        return self.motion.duration + self.impulses.delay

    @property
    def samples(self) -> int:
        """Number of time intervals of a joint motion, as many per second as in the original one; see JointMotion."""
        return ceil(cast("JointMotion", self.motion).samples * self.duration / self.motion.duration)

    @property
    def run_duration(self) -> float:
        """Default duration of a run plus the delay of the last impulse, in s."""
        return self.motion.run_duration + self.impulses.delay

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the shaped motion and two derivatives, shape (T, 3, n)."""
        start = self.motion.start
        motion = np.zeros((len(times), 3, len(start)))
        for at, share in zip(self.impulses.times, self.impulses.shares, strict=True):
            late = times - at
            part = self.motion.sample(np.maximum(late, 0.0))
            part[late < 0.0] = 0.0
            part[late < 0.0, 0] = start
            motion += share * part
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the path of the original motion."""
        return self.motion.distance_to_path(points)


@dataclass(frozen=True)
class Shifted(DerivedMotion):
    """Desired motion minus a constant offset; see Trajectory.

    Attributes:
        offset: Offset that is subtracted from the positions, shape (3,), in m.
    """

    offset: FloatArray

    @property
    def start(self) -> FloatArray:
        """Shifted start of the original motion."""
        return self.motion.start - self.offset

    @property
    def goal(self) -> FloatArray | None:
        """Shifted goal of the original motion."""
        return None if self.motion.goal is None else self.motion.goal - self.offset

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the shifted motion."""
        motion = self.motion.sample(times)
        motion[:, 0] -= self.offset
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the shifted path."""
        return self.motion.distance_to_path(points + self.offset)
