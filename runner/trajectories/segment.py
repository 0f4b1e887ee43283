"""Distance to a straight segment."""

import numpy as np

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
