"""Animated SVG of an arm in motion, without script, for the first screen of a report."""

from collections.abc import Iterable

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import GREY, INK, PALE, Camera
from runner.robots.model import RobotModel

_WIDTH, _HEIGHT, _MARGIN = 420.0, 300.0, 18.0
_FASTEST, _SLOWEST = 3.0, 5.0  # s; what moves longer by itself keeps readers from reading
_ARM, _PATH = palette.LIGHT[0], palette.LIGHT[1]


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
