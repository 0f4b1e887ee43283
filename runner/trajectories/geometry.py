"""Points and directions in trajectory configs, and distances from points to segments and curves."""

from collections.abc import Callable
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, ValidationInfo

from runner.base import portable
from runner.base.arrays import FloatArray

_PERPENDICULAR = 1e-6  # largest cosine of an angle that counts as a right angle


def _check_direction(value: list[float]) -> list[float]:
    if np.linalg.norm(value) == 0.0:
        raise ValueError("must have a direction, so not all zero")
    return value


def check_perpendicular(value: list[float], normal: list[float]) -> list[float]:
    """Return a direction after checking that it is perpendicular to a normal.

    Raises:
        ValueError: if it is not perpendicular; the message contains the angle.
    """
    unit, axis = (np.array(v) / np.linalg.norm(v) for v in (value, normal))
    cosine = float(unit @ axis)
    if abs(cosine) > _PERPENDICULAR:
        angle = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
        raise ValueError(f"must be perpendicular to normal {normal}, which is {angle:.4g} deg away")
    return value


def _check_in_plane(value: list[float], info: ValidationInfo) -> list[float]:
    return check_perpendicular(value, info.data["normal"]) if "normal" in info.data else value


Point = Annotated[list[float], Field(min_length=3, max_length=3)]
Direction = Annotated[Point, AfterValidator(_check_direction)]
InPlane = Annotated[Direction, AfterValidator(_check_in_plane)]
"""Direction perpendicular to the field `normal`, which must precede it in the model."""


def component(points: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the scalar product of points with a direction, shapes (..., 3) and (3,) to (...).

    `@` is not used, because the rounding of BLAS depends on the position of a point in the array.
    """
    product: FloatArray = points[..., 0] * direction[0] + points[..., 1] * direction[1] + points[..., 2] * direction[2]
    return product


def plane_axes(normal: list[float], direction: list[float]) -> tuple[FloatArray, FloatArray]:
    """Return two perpendicular unit vectors of a plane, each of shape (3,).

    Args:
        normal: Normal of the plane, of any length.
        direction: Direction of the first vector, perpendicular to the normal; rounding errors are removed.

    Returns:
        The first vector, and that vector rotated by 90 degrees counter-clockwise about the normal.
    """
    n, along = portable.unit(np.array(normal)), np.array(direction)
    first = portable.unit(along - n * portable.dot(n, along))
    return first, np.cross(n, first)


def distance_to_segment(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the distance of each point to a segment, shapes (..., 3), (3,), (3,) to (...), in m."""
    along = end - start
    length_squared = float(portable.dot(along, along))
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
