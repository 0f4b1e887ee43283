"""Motions derived from another: input-shaped against vibration of flexible arms, or with an offset."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from runner.base.arrays import FloatArray
from runner.trajectories.impulses import Impulses
from runner.trajectories.trajectory import OfTip, Trajectory

if TYPE_CHECKING:  # readers of stored runs use Shifted, and do without the simulator
    from runner.trajectories.joint_motion import JointMotion


@dataclass(frozen=True)
class DerivedMotion(OfTip):
    """A desired motion of the tip made of another, which it follows in what it does not change; see Trajectory.

    Attributes:
        motion: The motion.
    """

    motion: Trajectory

    @property
    def start(self) -> FloatArray:
        """Start of the motion."""
        return self.motion.start

    @property
    def goal(self) -> FloatArray | None:
        """Goal of the motion."""
        return self.motion.goal

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


@dataclass(frozen=True)
class Shaped(DerivedMotion):
    r"""A desired motion of the tip, convolved with impulses; see Trajectory for the attributes.

    .. math:: x_s(t) = \sum_i A_i x(t - t_i)

    and so its velocity and acceleration, at exact times, whatever the ticks; each x rests at the start before its time.
    The path is that of the motion as it is asked for, from which a shaped motion strays where it is curved.

    Attributes:
        motion: The motion, which comes to rest.
        impulses: The impulses.
    """

    impulses: Impulses

    @property
    def duration(self) -> float:
        """Time after which the motion rests, in s: later by the last impulse."""
        return self.motion.duration + self.impulses.delay

    @property
    def run_duration(self) -> float:
        """Time of a run, in s, longer by as much."""
        return self.motion.run_duration + self.impulses.delay

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the shaped motion."""
        return _convolved(self.motion.sample, self.motion.start, self.impulses, times)

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the path of the motion as it is asked for."""
        return self.motion.distance_to_path(points)


@dataclass(frozen=True)
class ShapedJoints:
    """A desired motion of the joints, convolved with impulses; see JointMotion, and Shaped.

    Attributes:
        motion: The motion.
        impulses: The impulses.
    """

    motion: "JointMotion"
    impulses: Impulses

    @property
    def duration(self) -> float:
        """Time after which the joints rest, in s: later by the last impulse."""
        return self.motion.duration + self.impulses.delay

    @property
    def samples(self) -> int:
        """As many in a second as the motion has."""
        return ceil(self.motion.samples * self.duration / self.motion.duration)

    def sample_joints(self, times: FloatArray) -> FloatArray:
        """Return the shaped motion."""
        start = self.motion.sample_joints(np.zeros(1))[0, 0]
        return _convolved(self.motion.sample_joints, start, self.impulses, times)


def _convolved(
    sample: Callable[[FloatArray], FloatArray], start: FloatArray, impulses: Impulses, times: FloatArray
) -> FloatArray:
    """Return a motion with two derivatives, shape (T, 3, k), convolved with impulses; at rest at its start before."""
    motion = np.zeros((len(times), 3, len(start)))
    for at, share in zip(impulses.times, impulses.shares, strict=True):
        late = times - at
        part = sample(np.maximum(late, 0.0))
        part[late < 0.0] = 0.0
        part[late < 0.0, 0] = start
        motion += share * part
    return motion


@dataclass(frozen=True)
class Shifted(DerivedMotion):
    """A desired motion less a constant offset; see Trajectory.

    Attributes:
        offset: What is subtracted from its positions, shape (3,), in m.
    """

    offset: FloatArray

    @property
    def start(self) -> FloatArray:
        """Start of the motion, shifted."""
        return self.motion.start - self.offset

    @property
    def goal(self) -> FloatArray | None:
        """Goal of the motion, shifted."""
        return None if self.motion.goal is None else self.motion.goal - self.offset

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion, shifted."""
        motion = self.motion.sample(times)
        motion[:, 0] -= self.offset
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the shifted path."""
        return self.motion.distance_to_path(points + self.offset)
