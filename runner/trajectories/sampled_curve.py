"""Quintic curve through samples of position and two derivatives."""

from math import comb

import numpy as np

from runner.base.arrays import FloatArray

_DEGREE = 5


class SampledCurve:
    """Curve that interpolates the positions and first two derivatives of samples.

    The curve between two samples is a Bezier curve (Farin, Curves and Surfaces for CAGD, 2002, chapter 5). The
    derivatives are Bezier curves of the differences of its control points.

    Args:
        times: Times of the samples, ascending, shape (N,), in s.
        samples: Position and two derivatives at each sample, shape (N, 3, k).
    """

    def __init__(self, times: FloatArray, samples: FloatArray) -> None:
        self._times, self._steps = times, np.diff(times)
        h = self._steps[:, None]
        before, after = samples[:-1], samples[1:]
        self._controls = np.stack(
            [
                before[:, 0],
                before[:, 0] + h * before[:, 1] / 5.0,
                before[:, 0] + 2.0 * h * before[:, 1] / 5.0 + h**2 * before[:, 2] / 20.0,
                after[:, 0] - 2.0 * h * after[:, 1] / 5.0 + h**2 * after[:, 2] / 20.0,
                after[:, 0] - h * after[:, 1] / 5.0,
                after[:, 0],
            ],
            axis=1,
        )

    def sample(self, times: FloatArray) -> FloatArray:
        """Return position and two derivatives at times from the first sample to the last, shapes (T,) to (T, 3, k)."""
        place = np.clip(np.searchsorted(self._times, times, side="right") - 1, 0, len(self._steps) - 1)
        step = self._steps[place][:, None]
        share = (times - self._times[place])[:, None] / step
        controls, scale, orders = self._controls[place], np.ones_like(step), []
        for degree in range(_DEGREE, _DEGREE - 3, -1):
            powers = np.arange(degree + 1)
            weights = np.array([comb(degree, power) for power in powers.tolist()])
            weights = weights * share**powers * (1.0 - share) ** (degree - powers)
            orders.append(scale * (weights[:, :, None] * controls).sum(axis=1))
            controls, scale = np.diff(controls, axis=1), scale * degree / step
        return np.stack(orders, axis=1)
