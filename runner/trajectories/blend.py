"""Quintic blend from 0 to 1, from rest to rest."""

import numpy as np

from runner.base.arrays import FloatArray


def quintic_blend(u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return s and its first two derivatives by u, each of shape (T,); u below 0 or above 1 counts as 0 or 1.

    .. math:: s(u) = 10 u^3 - 15 u^4 + 6 u^5

    is the only quintic with s(0) = 0, s(1) = 1 and zero first and second derivatives at both ends (thesis eq. 3.39).
    """
    u = np.clip(u, 0.0, 1.0)
    return (
        u**3 * (10.0 + u * (-15.0 + 6.0 * u)),
        30.0 * u**2 * (1.0 - u) ** 2,
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    )
