"""How a mass on a damper and a spring answers, in closed form."""

import numpy as np
from numpy.typing import NDArray

from runner.controllers.admittance_filter import Admittance, discretise
from runner.controllers.controller import FloatArray

ComplexArray = NDArray[np.complex128]


def step_response(law: Admittance, loads: FloatArray, times: FloatArray) -> FloatArray:
    r"""Return the displacement of each axis after a constant load sets in at rest.

    With a = B / 2M and b^2 = a^2 - K/M, real or imaginary,

    .. math:: x(t) = \frac{f}{K} \left( 1 - e^{-at} (\cosh bt + a t \frac{\sinh bt}{bt}) \right),

    and without a spring x = (f/B) (t - (1 - e^{-Bt/M}) M/B), without a damper too x = f t^2 / 2M.

    Args:
        law: The law.
        loads: f of each axis, shape (6,), in N and N m.
        times: Times since the load set in, shape (T,), in s.

    Returns:
        Shape (T, 6), in m and rad.
    """
    columns = [_step(M, B, K, f, times) for M, B, K, f in zip(law.mass, law.damping, law.stiffness, loads, strict=True)]
    return np.column_stack(columns)


def _step(M: float, B: float, K: float, f: float, t: FloatArray) -> FloatArray:
    if K > 0.0:
        a = B / (2.0 * M)
        bt = np.emath.sqrt(a**2 - K / M) * t
        faster, slower = np.exp(-a * t - bt), np.exp(-a * t + bt)  # no factor grows beyond 1
        small = np.abs(bt) < 1e-4
        safe = np.where(small, 1.0, bt)
        sinhc = np.where(small, np.exp(-a * t) * (1.0 + bt**2 / 6.0), (slower - faster) / (2.0 * safe))
        response: FloatArray = np.real(f / K * (1.0 - 0.5 * (slower + faster) - a * t * sinhc))
        return response
    if B > 0.0:
        return f / B * (t + np.expm1(-B * t / M) * M / B)
    return 0.5 * f * t**2 / M


def frequency_response(law: Admittance, frequencies: FloatArray) -> ComplexArray:
    """Return x / f = 1 / (M s^2 + B s + K) at s = i omega, shape (W, 6) (report eq. 8).

    Args:
        law: The law.
        frequencies: omega, shape (W,), in rad/s; above 0 where an axis has no spring.
    """
    s = np.asarray(1j * frequencies[:, None], dtype=np.complex128)
    response: ComplexArray = 1.0 / (law.mass * s**2 + law.damping * s + law.stiffness)
    return response


def sampled_frequency_response(law: Admittance, period: float, frequencies: FloatArray) -> ComplexArray:
    """Return what the sampled law answers to a sampled sine, sample by sample, shape (W, 6).

    It is [1, 0] (z - Phi)^-1 Gamma at z = exp(i omega h); holding the load costs about half a period of lag.

    Args:
        law: The law.
        period: h, in s.
        frequencies: omega, shape (W,), in rad/s; as in frequency_response, and below pi / h.
    """
    Phi, Gamma = discretise(law, period)
    z = np.exp(1j * period * frequencies)[:, None, None, None]
    response: ComplexArray = np.linalg.solve(z * np.eye(2) - Phi, Gamma[..., None])[..., 0, 0]
    return response
