"""Motion of a long recording, whose largest distance to a path is found without that of each point."""

from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.spatial import cKDTree

from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.trajectories.joint_motion import TipOfJoints

_STEPS = 2  # Newton steps to a point of the curve near the nearest one
_AT_ONCE = 64  # points
_ROUNDING = 1e-12  # m


@dataclass(frozen=True)
class LongMotion(TipOfJoints):
    """Motion of the tip that follows from a motion of the joints; see TipOfJoints.

    A metric of a run is the largest distance of its points to the path. Most points are nearer to some point of the
    curve than another point is to the whole curve, so their own distance does not matter.
    """

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return upper bounds of the distances, shapes (..., T, 3) to (..., T), in m; the largest of T is exact."""
        runs = points.reshape(-1, *points.shape[-2:])
        return np.stack([self._distances(run) for run in runs]).reshape(points.shape[:-1])

    def _distances(self, points: FloatArray) -> FloatArray:
        bounds = self._bounds(points) + _ROUNDING
        largest = 0.0
        order = np.argsort(-bounds, kind="stable")
        for first in range(0, len(order), _AT_ONCE):
            some = order[first : first + _AT_ONCE]
            if bounds[some[0]] <= largest:
                break
            bounds[some] = super().distance_to_path(points[some])
            largest = max(largest, float(bounds[some].max()))
        return np.minimum(bounds, largest)

    def _bounds(self, points: FloatArray) -> FloatArray:
        """Return the distance of each point to a point of the curve near it, shapes (T, 3) to (T,), in m."""
        times = self._samples
        bounds, nearest = cKDTree(self._curve.sample(times)[:, 0]).query(points)
        low, high = times[np.maximum(nearest - 1, 0)], times[np.minimum(nearest + 1, len(times) - 1)]
        place = times[nearest]
        for _ in range(_STEPS):
            c, c_prime, c_second = np.moveaxis(self._curve.sample(place), 1, 0)
            gap = c - points
            slope = (c_prime**2).sum(axis=1) + (gap * c_second).sum(axis=1)
            step = np.divide((gap * c_prime).sum(axis=1), slope, out=np.zeros_like(slope), where=slope > 0.0)
            place = np.clip(place - step, low, high)
        bounds = np.minimum(bounds, np.linalg.norm(self._curve.sample(place)[:, 0] - points, axis=1))
        return np.asarray(bounds, dtype=np.float64)


def with_long_motion(config: RunConfig) -> RunConfig:
    """Return the config of a run whose path is a LongMotion if it is a motion of the joints."""
    path = config.path
    if not isinstance(path, TipOfJoints):
        return config
    return replace(config, path=LongMotion(**{each.name: getattr(path, each.name) for each in fields(path)}))
