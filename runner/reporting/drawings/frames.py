"""The assignment of coordinate frames to an arm at home (thesis figures 3.1 and 4.1)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from runner.reporting.drawings.canvas import GREY, INK, PALE, Camera, arrow, circle, drawing, scene, triad, write
from runner.robots.denavit_hartenberg import denavit_hartenberg, frames
from runner.robots.model import FloatArray, RobotModel

_APART = (2.5, 2.4)  # of frames at one place: sideways from it, and from each other, in lengths of an axis


@drawing
def frame_assignment(model: RobotModel, first: int = 0, last: str = "E", camera: Camera | None = None) -> Figure:
    """Draw an arm at q = 0 with its joint axes and its D-H frames.

    Frames whose origins coincide or nearly so are drawn beside them, each tied to its true place by a dotted line.

    Args:
        model: The robot.
        first: Number of frame 0; the Mini of the thesis starts at 3. Joints count on from it.
        last: Name of the tip frame.
        camera: The view.
    """
    camera = camera or Camera()
    home = np.zeros(model.nq)
    poses = frames(denavit_hartenberg(model), home)
    names = [*(str(first + index) for index in range(model.nq)), last]
    joints = model.frame_poses(home, model.joint_names)[:, :3, 3]
    length = 0.17 * model.reach * np.sqrt(3.0 / max(3, model.nq))
    figure, axes = scene(4.6, 3.6)
    _draw_arm(axes, camera, np.vstack([np.zeros(3), joints, poses[-1, :3, 3]]), length)
    for index, (origin, axis) in enumerate(zip(joints, model.tip_jacobian(home)[3:].T, strict=True)):
        _draw_joint(axes, camera, origin, axis, length, f"$q_{{{first + index + 1}}}$")
    moved = _draw_frames(axes, camera, poses, names, length)
    if moved:
        note = "; ".join(f"frames {' and '.join(group)}" for group in moved)
        axes.annotate(f"{note}: drawn beside their origin", (0.5, 0.0), (0, -6), "axes fraction", "offset points",
                      ha="center", va="top", fontsize=7.5, color=GREY)  # fmt: skip
    axes.autoscale_view()
    return figure


def _draw_arm(axes: Axes, camera: Camera, points: FloatArray, length: float) -> None:
    foot = points[0] - [0.0, 0.0, 0.75 * length]
    axes.fill(*camera.project(circle(foot, np.array([0.0, 0.0, 1.0]), 0.75 * length)).T, color=PALE, zorder=0.5)
    for line in (np.vstack([foot, points[0]]), points):
        axes.plot(*camera.project(line).T, color=PALE, lw=8, solid_capstyle="round", solid_joinstyle="round", zorder=1)


def _draw_joint(axes: Axes, camera: Camera, origin: FloatArray, axis: FloatArray, length: float, label: str) -> None:
    """Draw a joint: its axis, and an arc about it in the sense of rotation."""
    line = origin + np.outer([-0.55, 1.0], axis) * length
    axes.plot(*camera.project(line).T, color=INK, lw=0.7, ls=(0, (9, 2, 2, 2)), zorder=2)
    axes.plot(*camera.project(origin), "o", ms=5, mfc="white", mec=INK, mew=1, zorder=4)
    arc = camera.project(circle(origin + 0.62 * length * axis, axis, 0.26 * length, turn=0.75))
    axes.plot(*arc[:-3].T, color=INK, lw=0.9, zorder=4.5)
    arrow(axes, arc[-5], arc[-1], INK, 0.9, 4.5)
    centre = arc.mean(axis=0)
    place = centre + 0.52 * length * np.array([1.0, 0.1] if abs(axis[2]) > 0.7 else [-0.75, 0.6])
    write(axes, place, label, size=9.5)


def _draw_frames(
    axes: Axes, camera: Camera, poses: FloatArray, names: list[str], length: float
) -> list[tuple[str, ...]]:
    """Draw all frames; return the names of those drawn beside their place, by place."""
    middle = camera.project(poses[:, :3, 3].max(axis=0) + poses[:, :3, 3].min(axis=0)) / 2.0
    groups: list[list[int]] = []
    for index, origin in enumerate(poses[:, :3, 3]):
        near = [group for group in groups if np.linalg.norm(poses[group[0], :3, 3] - origin) < 0.6 * length]
        if near:
            near[0].append(index)
        else:
            groups.append([index])
    for group in groups:
        centre = camera.project(poses[group, :3, 3].mean(axis=0))
        away = -_APART[0] if centre[0] <= middle[0] else _APART[0]
        for rank, index in enumerate(group):
            above = _APART[1] * ((len(group) - 1) / 2.0 - rank)
            at = camera.project(poses[index, :3, 3])
            place = at if len(group) == 1 else centre + length * np.array([away, above])
            if len(group) > 1:
                axes.plot(*np.column_stack([at, place]), color=GREY, lw=0.8, ls=":", zorder=1.5)
            axes.plot(*place, "o", ms=3, color=INK, zorder=6)
            triad(axes, camera, poses[index], place, length, names[index], 0.22 * length)
    return [tuple(names[index] for index in group) for group in groups if len(group) > 1]
