"""Interpolated motions between table rows, twice differentiable."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import splines

Interpolation = Literal["spline", "hermite"]

_LEAST, _PER_ROW, _MOST = 512, 64, 4096  # samples


@dataclass(frozen=True)
class Interpolated:
    """Interpolated motion through rows, from rest to rest.

    Attributes:
        times: Time of each row, ascending from 0, shape (N,), in s.
        orders: Position and its first two derivatives, as functions of time.
    """

    times: FloatArray
    orders: "Sequence[splines.CubicSpline | splines.BPoly]"

    @property
    def duration(self) -> float:
        """Time of the last row, in s."""
        return float(self.times[-1])

    @property
    def samples(self) -> int:
        """Number of equal time intervals, so short that the path bends only once in each of them."""
        return min(max(_PER_ROW * (len(self.times) - 1), _LEAST), _MOST)

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion and two derivatives, shape (T, 3, k); after its duration it rests at the last row."""
        within = np.clip(times, 0.0, self.duration)
        motion: FloatArray = np.stack([order(within) for order in self.orders], axis=1)
        motion[times > self.duration, 1:] = 0.0
        return motion


def interpolate(times: FloatArray, rows: FloatArray, kind: Interpolation) -> Interpolated:
    """Return a motion that passes each row at its time.

    `spline` is the cubic spline through the positions with zero velocity at both ends. Its velocities and accelerations
    are continuous. `hermite` also uses the given velocities, and accelerations if given. It is cubic between rows, with
    continuous velocities, or of fifth order, with continuous accelerations.

    Args:
        times: Time of each row, shape (N,), in s.
        rows: Positions and given derivatives, shape (N, orders, k).
        kind: Kind of interpolation.
    """
    if kind == "spline":
        spline = splines.CubicSpline(times, rows[:, 0], bc_type="clamped")
        return Interpolated(times, (spline, spline.derivative(1), spline.derivative(2)))
    curve = splines.BPoly.from_derivatives(times, rows)
    return Interpolated(times, (curve, curve.derivative(1), curve.derivative(2)))
