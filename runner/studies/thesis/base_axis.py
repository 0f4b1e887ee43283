"""Distance of a path from the base axis, times at the limit of joint 1, and divergence."""

from collections.abc import Callable, Mapping

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.charts.arm import top_view
from runner.reporting.document import Picture
from runner.reporting.figures import origin
from runner.store import Run
from runner.study.measured import Measured


def from_above(runs: Mapping[str, Run], name: str, caption: str) -> Picture:
    """Return the tip's path and the desired one, seen from above."""
    run = runs[name]
    drawing = top_view(run.model, run.vector("tip"), run.vector("desired"))
    return Picture(caption, drawing, "Path of the tip seen from above, passing the base axis", 0.7, origin(run))


def distance(signal: str) -> Callable[[Run], FloatArray]:
    """Return the distance of a path of the tip to the base axis at each tick, in m."""
    return lambda run: np.linalg.norm(run.vector(signal)[:, :2] - run.model.shoulder[:2], axis=1)


def passes(signal: str) -> Callable[[Run], float]:
    """Return the distance at which a path of the tip passes the base axis, between its ticks too, in m."""

    def least(run: Run) -> float:
        path, point = run.vector(signal)[:, :2], run.model.shoulder[:2]
        start, step = path[:-1], np.diff(path, axis=0)
        squared = np.maximum(np.einsum("ij,ij->i", step, step), 1e-300)
        share = np.clip(np.einsum("ij,ij->i", point - start, step) / squared, 0.0, 1.0)
        distances = np.linalg.norm(start + share[:, None] * step - point, axis=1)
        return float(np.min(distances[np.isfinite(distances)], initial=np.inf))

    return least


def ticks_at_limit(run: Run) -> float:
    """Return at how many ticks joint 1 is at its limit."""
    return float(len(_pinned(run)))


def at_limit(runs: Mapping[str, Run], name: str, end: int) -> Measured:
    """Return when joint 1 is at its limit: 0 for the first time, -1 for the last."""
    pinned = _pinned(runs[name])
    return Measured("joint 1 at its limit", float(pinned[end]) if len(pinned) else None, "s")


def diverging_joint(runs: Mapping[str, Run], name: str) -> str:
    """Return the joint with which a run diverges."""
    return str((runs[name].failure_record or {}).get("joint", "–"))


def _pinned(run: Run) -> FloatArray:
    """Return the times at which joint 1 is at its limit, in s."""
    limit = float(run.config["torque_limits"]["max"])
    return np.asarray(run.trace()["t"].to_numpy()[np.abs(run.trace()["tau1"].to_numpy()) >= limit * (1.0 - 1e-12)])
