"""Distance of a path from the base axis, times at the limit of joint 1, and divergence."""

from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.figure import Figure

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import GREY, INK, drawing
from runner.reporting.document import Picture
from runner.reporting.figures import origin
from runner.robots.model import RobotModel
from runner.store import Run
from runner.study.measured import Measured

_LONG = 5.2  # long side of the view from above, in inches


def from_above(runs: Mapping[str, Run], name: str, caption: str) -> Picture:
    """Return the tip's path and the desired one, seen from above."""
    run = runs[name]
    drawn = top_view(run.model, run.vector("tip"), run.vector("desired"))
    return Picture(caption, drawn, "Path of the tip seen from above, passing the base axis", 0.7, origin(run))


def distance(signal: str) -> Callable[[Run], FloatArray]:
    """Return the distance of a path of the tip to the base axis at each tick, in m."""
    return lambda run: np.linalg.norm(run.vector(signal)[:, :2] - run.model.shoulder[:2], axis=1)


def passes(signal: str) -> Callable[[Run], float]:
    """Return the distance at which a path of the tip passes the base axis, between its ticks too, in m."""

    def least(run: Run) -> float:
        return _nearest(run.vector(signal)[:, :2], run.model.shoulder[:2])[1]

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


@drawing
def top_view(model: RobotModel, path: FloatArray, desired: FloatArray | None = None) -> Figure:
    """Draw the path of the tip seen from above, with the place where it passes closest to the base axis.

    Args:
        model: The robot; its base axis is the vertical through its shoulder.
        path: Path of the tip, shape (N, 3), in m.
        desired: Desired path, shape (M, 3), in m.
    """
    centre = model.shoulder[:2]
    flat = path[:, :2]
    low, high = np.vstack([flat, centre]).min(axis=0), np.vstack([flat, centre]).max(axis=0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0 + 0.1 * model.reach
    half = np.maximum(half, 0.35 * half.max())
    width, height = _LONG * half[[1, 0]] / half.max()
    figure = Figure(figsize=(width, height))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(middle[1] - half[1], middle[1] + half[1]), ylim=(middle[0] + half[0], middle[0] - half[0]))
    # y to the right and x downwards: what an observer above the arm sees after a quarter turn.
    axes.plot(flat[:, 1], flat[:, 0], color=palette.LIGHT[1], lw=1.4, label="path of the tip", zorder=3)
    if desired is not None:
        axes.plot(desired[:, 1], desired[:, 0], color=INK, lw=1.0, ls=(0, (4, 2)), label="desired path", zorder=4)
    for point, word, shift in ((flat[0], "start", (4, 5)), (flat[-1], "end", (4, 5))):
        axes.plot(point[1], point[0], "o", ms=4.5, color=palette.LIGHT[1], zorder=4)
        axes.annotate(word, (point[1], point[0]), shift, textcoords="offset points", fontsize=7.5)
    axes.plot(centre[1], centre[0], "o", ms=7, mfc="white", mec=INK, zorder=5)
    axes.plot(centre[1], centre[0], "o", ms=2, color=INK, zorder=5, label="base axis")
    nearest, distance = _nearest(flat, centre)
    axes.plot([centre[1], nearest[1]], [centre[0], nearest[0]], color=INK, lw=0.9, zorder=4)
    axes.annotate(quantity(distance, "m"), (nearest[1], nearest[0]), (-12, -14), textcoords="offset points", ha="right",
                  va="top", arrowprops={"arrowstyle": "-", "color": GREY, "lw": 0.6})  # fmt: skip
    axes.grid(color="#e3e6ea", lw=0.5)
    axes.set_xlabel("$y$ (m)")
    axes.set_ylabel("$x$ (m)")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=7.5, frameon=False)
    return figure


def _nearest(path: FloatArray, point: FloatArray) -> tuple[FloatArray, float]:
    """Return the point of a polyline in the plane that lies closest to a point, and its distance in m."""
    start, step = path[:-1], np.diff(path, axis=0)
    squared = np.maximum(np.einsum("ij,ij->i", step, step), 1e-300)
    share = np.clip(np.einsum("ij,ij->i", point - start, step) / squared, 0.0, 1.0)
    feet = start + share[:, None] * step
    distances = np.linalg.norm(feet - point, axis=1)
    distances = np.where(np.isfinite(distances), distances, np.inf)
    index = int(np.argmin(distances))
    return feet[index], float(distances[index])
