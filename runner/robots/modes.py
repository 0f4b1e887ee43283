"""Natural vibration modes of an arm: frequencies, damping ratios and amplitudes."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray


class Mode(NamedTuple):
    """Natural vibration mode.

    Attributes:
        frequency: Undamped frequency, in Hz.
        damping_ratio: Damping ratio, from 0 to below 1.
    """

    frequency: float
    damping_ratio: float

    def amplitude(self, times: FloatArray, signal: FloatArray, after: float) -> float:
        """Return the amplitude of this mode in a signal at the start of its free vibration.

        The mode and a constant are fitted to the signal from this time to the end.

        Args:
            times: Times of the samples, ascending, shape (T,), in s.
            signal: Samples of the signal, shape (T,).
            after: Start of the free vibration, in s.
        """
        on, omega = times >= after - 1e-9, 2.0 * np.pi * self.frequency
        since = times[on] - after
        phase = omega * np.sqrt(1.0 - self.damping_ratio**2) * since
        fall = np.exp(-self.damping_ratio * omega * since)
        waves = np.stack([fall * np.cos(phase), fall * np.sin(phase), np.ones_like(since)], axis=1)
        return float(np.hypot(*np.linalg.lstsq(waves, signal[on], rcond=None)[0][:2]))


def find_modes(M: FloatArray, D: FloatArray, K: FloatArray) -> list[Mode]:
    r"""Return the vibration modes of a system in order of frequency; overdamped motions are left out.

    .. math:: M \ddot x + D \dot x + K x = 0, \qquad s = -\zeta \omega \pm j \omega \sqrt{1 - \zeta^2}

    Args:
        M: Mass matrix, shape (n, n), positive definite.
        D: Damping matrix, shape (n, n).
        K: Stiffness matrix, shape (n, n).
    """
    roots = _roots(M, D, K)
    rates = np.abs(roots)
    ringing = roots.imag > 1e-9 * rates.max()
    return sorted(
        Mode(rate / (2.0 * np.pi), -root.real / rate) for rate, root in zip(rates[ringing], roots[ringing], strict=True)
    )


def largest_rate(M: FloatArray, D: FloatArray, K: FloatArray) -> float:
    """Return the largest magnitude of s in find_modes, in 1/s; K and D can be singular."""
    return float(np.abs(_roots(M, D, K)).max())


def _roots(M: FloatArray, D: FloatArray, K: FloatArray) -> NDArray[np.complex128]:
    n = len(M)
    slopes = np.linalg.solve(M, np.hstack([-K, -D]))
    return np.asarray(np.linalg.eigvals(np.vstack([np.eye(n, 2 * n, n), slopes])), dtype=np.complex128)
