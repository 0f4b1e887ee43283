"""Motions derived from another: input-shaped against vibration of flexible arms, or with an offset."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, exp, pi, prod, sqrt
from typing import TYPE_CHECKING, Literal, cast

import numpy as np

from runner.base.arrays import FloatArray
from runner.trajectories.trajectory import OfTip, Trajectory

if TYPE_CHECKING:  # readers of stored runs use Shifted and do not need the simulator
    from runner.trajectories.joint_motion import JointMotion

ShaperKind = Literal["zv", "zvd"]


@dataclass(frozen=True)
class Impulses:
    """A sequence of impulses, to be convolved with a motion.

    Attributes:
        times: Time of each impulse, ascending from 0, shape (N,), in s.
        shares: Amplitude A_i of each impulse, shape (N,), with sum 1.
    """

    times: FloatArray
    shares: FloatArray

    @property
    def delay(self) -> float:
        """Time that the impulses add to the motion, in s."""
        return float(self.times[-1])

    def residual(self, frequency: float, damping_ratio: float = 0.0) -> float:
        r"""Return the residual vibration of a mode after the shaped motion, relative to that after the unshaped motion.

        With omega = 2 pi f and omega_d = omega sqrt(1 - zeta^2), Singer and Seering (1990):

        .. math:: V = e^{-\zeta \omega t_N} \left| \sum_i A_i e^{\zeta \omega t_i} e^{j \omega_d t_i} \right|

        Without damping, it is |cos(pi/2 f/f_0)| for ZV at the design frequency f_0, and its square for ZVD.

        Args:
            frequency: Undamped frequency f of the mode, in Hz.
            damping_ratio: Damping ratio zeta of the mode, below 1.
        """
        rate = 2.0 * np.pi * frequency * (damping_ratio + 1j * np.sqrt(1.0 - damping_ratio**2))
        return float(np.abs(self.shares @ np.exp(rate * self.times - rate.real * self.delay)))


def zero_vibration(kind: ShaperKind, frequency: float, damping_ratio: float) -> Impulses:
    r"""Return the impulses that leave a mode at rest: ZV or ZVD, respectively (Singer and Seering 1990).

    .. math:: A_i = \frac{1}{1 + k}, \frac{k}{1 + k}, \qquad A_i = \frac{1}{(1 + k)^2}, \frac{2 k}{(1 + k)^2},
        \frac{k^2}{(1 + k)^2}, \qquad k = e^{-\zeta \pi / \sqrt{1 - \zeta^2}}

    The impulses are half a damped period apart. With ZVD, the derivatives of the residual vibration by frequency and
    damping are also zero.

    Args:
        kind: ZV or ZVD.
        frequency: Undamped frequency of the mode, in Hz.
        damping_ratio: Damping ratio of the mode, below 1.
    """
    root = sqrt(1.0 - damping_ratio**2)
    half, k = 0.5 / (frequency * root), exp(-damping_ratio * pi / root)
    once = Impulses(np.array([0.0, half]), np.array([1.0, k]) / (1.0 + k))
    if kind == "zv":
        return once
    return Impulses(half * np.arange(3.0), np.array([1.0, 2.0 * k, k**2]) / (1.0 + k) ** 2)


def in_turn(sequences: Sequence[Impulses]) -> Impulses:
    """Return the convolution of sequences; it leaves each mode at rest that one of the sequences leaves at rest."""
    pairs = [list(zip(each.times, each.shares, strict=True)) for each in sequences]
    both = sorted((sum(t for t, _ in each), prod(share for _, share in each)) for each in product(*pairs))
    return Impulses(*np.array(both).T)


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
