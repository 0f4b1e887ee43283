"""Input shapers (ZV and ZVD impulse sequences) and their residual vibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray

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
    root = np.sqrt(1.0 - damping_ratio**2)
    half, k = 0.5 / (frequency * root), np.exp(-damping_ratio * np.pi / root)
    once = Impulses(np.array([0.0, half]), np.array([1.0, k]) / (1.0 + k))
    if kind == "zv":
        return once
    return Impulses(half * np.arange(3), np.array([1.0, 2.0 * k, k**2]) / (1.0 + k) ** 2)


def in_turn(sequences: Sequence[Impulses]) -> Impulses:
    """Return the convolution of sequences; it leaves each mode at rest that one of the sequences leaves at rest."""
    pairs = [list(zip(each.times, each.shares, strict=True)) for each in sequences]
    both = sorted((sum(t for t, _ in each), prod(share for _, share in each)) for each in product(*pairs))
    return Impulses(*np.array(both).T)
