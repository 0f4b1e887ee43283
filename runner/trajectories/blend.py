"""Quintic blend from 0 to 1, from rest to rest."""

import numpy as np

from runner.base.arrays import FloatArray


def quintic_blend(u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return s and its first two derivatives in u, each of shape (T,), for u from 0 to 1 and at rest beyond.

    .. math:: s(u) = 10 u^3 - 15 u^4 + 6 u^5

    is the one quintic with s(0) = 0, s(1) = 1 and no first or second derivative at either end (thesis eq. 3.39).
    """
    u = np.clip(u, 0.0, 1.0)
    return (
        u**3 * (10.0 + u * (-15.0 + 6.0 * u)),
        30.0 * u**2 * (1.0 - u) ** 2,
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    )


def quintic_motion(start: FloatArray, goal: FloatArray, duration: float, times: FloatArray) -> FloatArray:
    """Return the motion from start to goal by the blend, with two derivatives, shapes (k,), (k,), (T,) to (T, 3, k)."""
    blend, rate = quintic_blend(times / duration), 1.0 / duration
    motion = np.stack([np.outer(s * rate**order, goal - start) for order, s in enumerate(blend)], axis=1)
    motion[:, 0] += start
    return motion
