"""Closed form of the displacement of an admittance law after a step of the load."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.force.admittance_filter import Admittance


def step_response(law: Admittance, loads: FloatArray, times: FloatArray) -> FloatArray:
    r"""Return the displacement of each axis after a constant load sets in at rest, shape (T, 6), in m and rad.

    With a = B / 2M and b^2 = a^2 - K/M, real or imaginary,

    .. math:: x(t) = \frac{f}{K} \left( 1 - e^{-at} (\cosh bt + a t \frac{\sinh bt}{bt}) \right),

    and without a spring x = (f/B) (t - (1 - e^{-Bt/M}) M/B), without a damper too x = f t^2 / 2M.
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
