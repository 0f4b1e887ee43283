"""Pictures of an arm in motion, still and animated."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from runner.base.arrays import FloatArray
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import GREY, INK, PALE, Camera, drawing, pair, scene, triad
from runner.robots.model import RobotModel

_ARM, _PATH, _GOAL = palette.LIGHT[:3]
_SHADES = LinearSegmentedColormap.from_list("instants", ["#b9cfe8", palette.LIGHT[0], "#0c2b52"])
WIDE = 5.4
"""Width of a still picture, in inches, from which on its legend is on the right."""
_SHARE, _WITHIN = 3.8 / 5.4, 0.94  # of a still: height over width, and what labels leave of a narrow one
_ENTRY = 85.0  # pt of a legend's entry
_WIDTH, _HEIGHT, _MARGIN = 420.0, 300.0, 18.0
_FASTEST, _SLOWEST = 3.0, 5.0  # s; what moves longer by itself keeps readers from reading


@drawing
def arm_motion(
    model: RobotModel,
    q: FloatArray,
    times: Sequence[float],
    path: FloatArray | None = None,
    desired: FloatArray | None = None,
    goal: FloatArray | None = None,
    camera: Camera | None = None,
    has_words: bool = True,
    width: float = WIDE,
) -> Figure:
    """Draw an arm at several instants in one picture, light at first and dark at last.

    Args:
        model: The robot.
        q: Joint positions at each instant, shape (K, nq), in rad; up to eight can be distinguished.
        times: The instants, length K, in s.
        path: Path of the tip, shape (N, 3), in m.
        desired: Desired path, shape (M, 3), in m.
        goal: Goal of the tip, shape (3,), in m.
        camera: The view.
        has_words: Whether it has a legend and labels.
        width: Width, in inches: without the legend, which is on the right, or of a narrower one with it below.
    """
    camera = camera or Camera(32.0, 18.0)
    chains = np.array([[*model.frame_poses(row, model.joint_names)[:, :3, 3], model.tip_position(row)] for row in q])
    figure, axes = scene(width if width >= WIDE else _WITHIN * width, _SHARE * width)
    points = np.vstack([chains.reshape(-1, 3), *(p for p in (path, desired) if p is not None)])
    floor = min(0.0, float(points[:, 2].min())) - 0.05 * model.reach
    _draw_floor(axes, camera, points, floor, has_words)
    _draw_base(axes, camera, model, floor, has_words)
    for number, chain in enumerate(chains):
        color = _SHADES(number / max(1, len(chains) - 1))
        flat = camera.project(chain)
        axes.plot(*flat.T, color=color, lw=3, solid_capstyle="round", solid_joinstyle="round", zorder=2 + 0.1 * number,
                  label=f"{times[number]:.3g} s" if len(chains) > 1 else None)  # fmt: skip
        axes.plot(*flat.T, "o", ms=4, mfc="white", mec=color, mew=1.1, zorder=2.05 + 0.1 * number)
    if path is not None:
        shadow = np.column_stack([path[:, :2], np.full(len(path), floor)])
        axes.plot(*camera.project(shadow).T, color=PALE, lw=1.6, zorder=1)
        axes.plot(*camera.project(path).T, color=_PATH, lw=1.4, zorder=5, label="path of the tip")
    if desired is not None:
        axes.plot(*camera.project(desired).T, color=INK, lw=1.0, ls=(0, (4, 2)), zorder=5.5, label="desired path")
    if goal is not None:
        axes.plot(*camera.project(goal), "*", ms=11, mfc=_GOAL, mec="white", mew=0.7, zorder=6, label="goal", ls="none")
    if has_words and axes.get_legend_handles_labels()[0]:
        columns = max(1, int(72.0 * width / _ENTRY))
        beside: Any = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5)}
        below: Any = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "ncols": columns, "columnspacing": 1.0}
        axes.legend(**(beside if width >= WIDE else below), frameon=False, fontsize=7.5, handlelength=1.8)
    return figure


def _draw_floor(axes: Axes, camera: Camera, points: FloatArray, floor: float, has_words: bool) -> None:
    """Draw a grid on the floor with lines a round distance apart, and its label."""
    span = float(np.ptp(points[:, :2], axis=0).max())
    cell = 10.0 ** np.floor(np.log10(max(span, 1e-9)))
    cell = cell / 2.0 if span / cell >= 2.0 else cell / 5.0
    low = np.floor(np.minimum(points[:, :2].min(axis=0), 0.0) / cell - 0.2) * cell
    high = np.ceil(np.maximum(points[:, :2].max(axis=0), 0.0) / cell + 0.2) * cell
    for x in np.arange(low[0], high[0] + cell / 2.0, cell):
        axes.plot(*camera.project(np.array([[x, low[1], floor], [x, high[1], floor]])).T, color=PALE, lw=0.5, zorder=0)
    for y in np.arange(low[1], high[1] + cell / 2.0, cell):
        axes.plot(*camera.project(np.array([[low[0], y, floor], [high[0], y, floor]])).T, color=PALE, lw=0.5, zorder=0)
    if not has_words:
        return
    corner = camera.project(np.array([high[0], low[1], floor]))
    axes.annotate(f"grid: {cell:g} m", pair(corner), (0, -4), textcoords="offset points", va="top", ha="center",
                  fontsize=7.5, color=GREY)  # fmt: skip


def _draw_base(axes: Axes, camera: Camera, model: RobotModel, floor: float, has_words: bool) -> None:
    shoulder = model.shoulder
    foot = np.array([shoulder[0], shoulder[1], floor])
    top = shoulder + np.array([0.0, 0.0, 0.6 * model.reach])
    axes.plot(*camera.project(np.array([foot, top])).T, color=GREY, lw=0.8, ls=(0, (9, 2, 2, 2)), zorder=1.2)
    if not has_words:
        return
    axes.annotate("base axis", pair(camera.project(top)), (0, 3), textcoords="offset points", ha="center", fontsize=7.5,
                  color=GREY)  # fmt: skip
    triad(axes, camera, np.eye(4), camera.project(foot), 0.2 * model.reach, "", 0.05 * model.reach)


def moving_arm(model: RobotModel, q: FloatArray, seconds: float, path: FloatArray, desired: FloatArray) -> str:
    """Return an SVG of an arm that goes through a motion once, and stays at its end.

    Args:
        model: The robot.
        q: Joint positions at evenly spaced instants, shape (K, nq), in rad.
        seconds: How long the motion takes; it is shown as long, between 3 and 5 s.
        path: Path of the tip, shape (N, 3), in m.
        desired: Desired path, shape (M, 3), in m.
    """
    camera = Camera(32.0, 18.0)
    chains = [np.array([*model.frame_poses(row, model.joint_names)[:, :3, 3], model.tip_position(row)]) for row in q]
    axis = model.shoulder + model.reach * np.array([[0.0, 0.0, -0.1], [0.0, 0.0, 0.6]])
    flat = [camera.project(points) for points in (*chains, path, desired, axis)]
    everything = np.vstack(flat)
    low, span = everything.min(axis=0), np.maximum(np.ptp(everything, axis=0), 1e-9)
    scale = float(np.min((np.array([_WIDTH, _HEIGHT]) - 2.0 * _MARGIN) / span))
    shift = 0.5 * (np.array([_WIDTH, _HEIGHT]) - scale * span)
    *frames, tip, wanted, upright = (
        [(x, _HEIGHT - y) for x, y in (shift + scale * (points - low)).tolist()] for points in flat
    )
    shown = min(max(seconds, _FASTEST), _SLOWEST)
    arm = ";".join(map(_points, frames))
    joints = "".join(
        f'<circle r="4" fill="#fff" stroke="{_ARM}" stroke-width="1.6">'
        f"{_animated('cx', [frame[joint][0] for frame in frames], shown)}"
        f"{_animated('cy', [frame[joint][1] for frame in frames], shown)}</circle>"
        for joint in range(len(frames[0]))
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}">'
        f'<polyline points="{_points(upright)}" fill="none" stroke="{GREY}" stroke-dasharray="9 3 2 3"/>'
        f'<polyline points="{_points(tip)}" fill="none" stroke="{_PATH}" stroke-width="1.6"/>'
        f'<polyline points="{_points(wanted)}" fill="none" stroke="{INK}" stroke-dasharray="5 3"/>'
        f'<polyline points="{_points(frames[0])}" fill="none" stroke="{PALE}" stroke-width="6" stroke-linecap="round" '
        'stroke-linejoin="round"/>'
        f'<polyline points="{_points(frames[0])}" fill="none" stroke="{_ARM}" stroke-width="6" stroke-linecap="round" '
        f'stroke-linejoin="round"><animate attributeName="points" values="{arm}" dur="{shown:g}s" '
        f'fill="freeze"/></polyline>{joints}</svg>'
    )


def _points(points: Iterable[tuple[float, float]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _animated(name: str, values: Iterable[float], seconds: float) -> str:
    listed = ";".join(f"{value:.1f}" for value in values)
    return f'<animate attributeName="{name}" values="{listed}" dur="{seconds:g}s" fill="freeze"/>'
