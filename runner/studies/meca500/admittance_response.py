"""Closed-form step and frequency responses of a mass-spring-damper admittance."""

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.controllers.force.admittance_filter import Admittance, discretise

ComplexArray = NDArray[np.complex128]


def step_response(law: Admittance, loads: FloatArray, times: FloatArray) -> FloatArray:
    r"""Return the displacement of each axis after a constant load sets in at rest.

    With a = B / 2M and b^2 = a^2 - K/M, real or imaginary,

    .. math:: x(t) = \frac{f}{K} \left( 1 - e^{-at} (\cosh bt + a t \frac{\sinh bt}{bt}) \right),

    and without a spring x = (f/B) (t - (1 - e^{-Bt/M}) M/B), without a damper too x = f t^2 / 2M. In m and rad.
    """
    axes = zip(law.mass, law.damping, law.stiffness, loads, strict=True)
    return np.column_stack([_step(M, B, K, f, times) for M, B, K, f in axes])


def _step(M: float, B: float, K: float, f: float, t: FloatArray) -> FloatArray:
    if K > 0.0:
        a = B / (2.0 * M)
        bt = np.emath.sqrt(a**2 - K / M) * t
        faster, slower = np.exp(-a * t - bt), np.exp(-a * t + bt)  # no factor grows beyond 1
        small = np.abs(bt) < 1e-4
        safe = np.where(small, 1.0, bt)
        sinhc = np.where(small, np.exp(-a * t) * (1.0 + bt**2 / 6.0), (slower - faster) / (2.0 * safe))
        return np.real(f / K * (1.0 - 0.5 * (slower + faster) - a * t * sinhc))
    if B > 0.0:
        return f / B * (t + np.expm1(-B * t / M) * M / B)
    return 0.5 * f * t**2 / M


def frequency_response(law: Admittance, frequencies: FloatArray) -> ComplexArray:
    """Return x / f = 1 / (M s^2 + B s + K) at s = i omega in rad/s, above 0 without a spring, shape (W, 6) (eq. 8)."""
    s = np.asarray(1j * frequencies[:, None], dtype=np.complex128)
    return 1.0 / (law.mass * s**2 + law.damping * s + law.stiffness)


def sampled_frequency_response(law: Admittance, period: float, frequencies: FloatArray) -> ComplexArray:
    """Return what the sampled law answers to a sampled sine, sample by sample, shape (W, 6).

    It is [1, 0] (z - Phi)^-1 Gamma at z = exp(i omega h); holding the load costs about half a period, h, of lag. The
    frequencies are those of frequency_response, below pi / h.
    """
    Phi, Gamma = discretise(law, period)
    z = np.exp(1j * period * frequencies)[:, None, None, None]
    return np.linalg.solve(z * np.eye(2) - Phi, Gamma[..., None])[..., 0, 0]
