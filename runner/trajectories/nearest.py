"""Distance to a straight segment, and to the nearest point on a curve by numerical search."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray


def distance_to_segment(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the distance of each point to a segment, shapes (..., 3), (3,), (3,) to (...), in m."""
    along = end - start
    length_squared = float(along @ along)
    share = np.zeros(points.shape[:-1])
    if length_squared > 0.0:
        for axis in range(3):
            share += (points[..., axis] - start[axis]) * along[axis]
        share /= length_squared
        np.clip(share, 0.0, 1.0, out=share)
    squared = np.zeros_like(share)
    for axis in range(3):
        squared += (points[..., axis] - (start[axis] + share * along[axis])) ** 2
    return np.sqrt(squared)


_TABLE = 50_000  # distances from points to samples in one table
_SEARCHED = 20_000  # points in one search
_MAX_STEPS = 60
_CONVERGED = 1e-14  # step size at convergence, as a fraction of the parameter range of the curve


def distance_to_curve(points: FloatArray, curve: Callable[[FloatArray], FloatArray], samples: FloatArray) -> FloatArray:
    """Return the distance of each point to a curve, exact to rounding, shapes (..., 3) to (...), in m.

    A search starts at each sample that is nearer to the point than both neighbours and close enough to be next to the
    nearest point of the curve. It finds, between the neighbours, where the line to the point is perpendicular to the
    curve. The smallest distance counts. The samples must be dense: between two samples the distance has one minimum,
    and the curve is at most twice as long as the straight segment.

    Args:
        points: The points, shape (..., 3), in m.
        curve: Function of the parameters, shape (N,); returns points and first two derivatives, shape (N, 3, 3).
        samples: Ascending parameters from the start of the curve to its end, shape (M,).
    """
    every = points.reshape(-1, 3)
    at_samples = curve(samples)[:, 0]
    distance = np.empty(len(every))
    for first in range(0, len(every), _SEARCHED):
        chunk = slice(first, first + _SEARCHED)
        distance[chunk] = _nearest(every[chunk], curve, samples, at_samples)
    return distance.reshape(points.shape[:-1])


def _nearest(
    points: FloatArray, curve: Callable[[FloatArray], FloatArray], samples: FloatArray, at_samples: FloatArray
) -> FloatArray:
    rows = max(1, _TABLE // len(samples))
    starts = [_starts(points[first : first + rows], at_samples) for first in range(0, len(points), rows)]
    which = np.concatenate([first * rows + which for first, (which, _, _) in enumerate(starts)])
    sample = np.concatenate([sample for _, sample, _ in starts])
    last = len(samples) - 1
    place = _perpendicular(
        points[which],
        curve,
        samples[np.maximum(sample - 1, 0)],
        samples[np.minimum(sample + 1, last)],
        _CONVERGED * abs(float(samples[-1])),
    )
    distance: FloatArray = np.concatenate([nearest for _, _, nearest in starts])
    np.minimum.at(distance, which, np.linalg.norm(curve(place)[:, 0] - points[which], axis=1))
    return distance


def _starts(points: FloatArray, at_samples: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]:
    """Return the starts of searches as indices of point and sample, and each point's distance to its nearest sample."""
    squared = np.zeros((len(points), len(at_samples)))
    for axis in range(3):  # a matrix product would round a point depending on its position in the array
        squared += (points[:, axis, None] - at_samples[:, axis]) ** 2
    nearest: FloatArray = np.sqrt(squared.min(axis=1))
    reach = 2.0 * float(np.linalg.norm(np.diff(at_samples, axis=0), axis=1).max())
    low = squared <= (nearest + reach)[:, None] ** 2
    low[:, 1:] &= squared[:, 1:] <= squared[:, :-1]
    low[:, :-1] &= squared[:, :-1] <= squared[:, 1:]
    which, sample = np.nonzero(low)
    return which, sample, nearest


def _perpendicular(
    points: FloatArray, curve: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray, enough: float
) -> FloatArray:
    """Return parameters where g = (c - p) . c' vanishes, by Newton steps, or by bisection if a step leaves low..high.

    The search ends after a step of at most `enough`. It starts in the middle, because at an end of the curve where the
    motion rests c' is zero, and therefore g is zero for every point.
    """
    place = 0.5 * (low + high)
    searching = np.arange(len(points))
    for _ in range(_MAX_STEPS):
        here = place[searching]
        c, c_prime, c_second = np.moveaxis(curve(here), 1, 0)
        gap = c - points[searching]
        g = (gap * c_prime).sum(axis=1)
        slope = (c_prime**2).sum(axis=1) + (gap * c_second).sum(axis=1)
        low[searching] = np.where(g < 0.0, here, low[searching])
        high[searching] = np.where(g > 0.0, here, high[searching])
        newton = here - np.divide(g, slope, out=np.full_like(g, np.inf), where=slope > 0.0)
        within = (newton >= low[searching]) & (newton <= high[searching])
        place[searching] = np.where(within, newton, 0.5 * (low[searching] + high[searching]))
        searching = searching[np.abs(place[searching] - here) > enough]
        if len(searching) == 0:
            break
    return place
