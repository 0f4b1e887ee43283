"""Distance of a path from the base axis, and ticks of joint 1 at its limit."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.store import Run


def distance(signal: str) -> Callable[[Run], FloatArray]:
    """Return the distance of a path of the tip to the base axis at each tick, in m."""
    return lambda run: np.linalg.norm(run.vector(signal)[:, :2] - run.model.shoulder[:2], axis=1)


def passes(signal: str) -> Callable[[Run], float]:
    """Return the distance at which a path of the tip passes the base axis, between its ticks too, in m."""
    return lambda run: distance_between(run.vector(signal)[:, :2], run.model.shoulder[:2])


def distance_between(path: FloatArray, point: FloatArray) -> float:
    """Return the smallest distance of a polyline, shape (N, 2), from a point, in m."""
    start, step = path[:-1], np.diff(path, axis=0)
    squared = np.maximum(np.einsum("ij,ij->i", step, step), 1e-300)
    share = np.clip(np.einsum("ij,ij->i", point - start, step) / squared, 0.0, 1.0)
    distances = np.linalg.norm(start + share[:, None] * step - point, axis=1)
    return float(np.min(distances[np.isfinite(distances)], initial=np.inf))


def ticks_at_limit(run: Run) -> float:
    """Return at how many ticks joint 1 is at its limit."""
    limit = float(run.config["torque_limits"]["max"])
    return float(np.count_nonzero(np.abs(run.signal("tau1")) >= limit * (1.0 - 1e-12)))
