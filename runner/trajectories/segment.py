"""Geometry of a straight segment."""

import numpy as np

from runner.trajectories.trajectory import FloatArray


def distance_to_segment(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the distance of each point to a segment, shapes (T, 3), (3,), (3,) to (T,), in m."""
    along = end - start
    length_squared = float(along @ along)
    share = np.zeros(len(points)) if length_squared == 0.0 else (points - start) @ along / length_squared
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * along
    distance: FloatArray = np.linalg.norm(points - nearest, axis=1)
    return distance
