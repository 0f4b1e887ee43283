"""Coordinate frames of an arm at its home configuration (thesis figures 3.1, 4.1 and 5.1)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from runner.base.arrays import FloatArray
from runner.papers.studies.thesis.denavit_hartenberg import denavit_hartenberg, frames
from runner.reporting.charts.canvas import GREY, INK, PALE, Camera, arrow, circle, drawing, scene, triad, write
from runner.robots.model import RobotModel

_ASIDE = (2.5, 0.0)  # of frames at one place: from it, sideways and upwards, in lengths of an axis
_APART = 2.4  # of frames at one place: from each other
_NEAR = 0.6  # distance up to which origins count as one place, in lengths of an axis
_DETAIL = np.array([5.6, 1.2])  # from the small part to its enlargement, in lengths of an axis
_DETAIL_ASIDE = (4.4, 2.4)  # as _ASIDE, clear of the circles and the lines between them
_LINK = 2.7  # size of the enlarged part, in lengths of an axis


@dataclass(frozen=True)
class _Part:
    """Part of a drawing: the whole arm, or its small end.

    Attributes:
        line: Corners of the arm, shape (N, 3), in m.
        joints: Number, origin and axis of its joints.
        frames: Name and pose of its frames.
        aside: Offset of frames at one place from it, sideways and upwards, in lengths of an axis.
    """

    line: FloatArray
    joints: Sequence[tuple[int, FloatArray, FloatArray]]
    frames: Sequence[tuple[str, FloatArray]]
    aside: tuple[float, float] = _ASIDE


@drawing
def frame_assignment(model: RobotModel, first: int = 0, last: str = "E", camera: Camera | None = None) -> Figure:
    """Draw an arm at q = 0 with its joint axes and its D-H frames.

    Frames whose origins coincide or nearly so are drawn next to them, each tied to its true place by a dotted line.
    If the outer joints would overlap (a small arm on a large one), they are drawn again, enlarged, with their frames.

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
    origins = model.frame_poses(home, model.joint_names)[:, :3, 3]
    axes_of = np.round(model.tip_jacobian(home)[3:].T, 12)  # so that arcs about parallel axes begin alike
    numbers = range(first + 1, first + 1 + model.nq)
    length = 0.17 * model.reach * np.sqrt(3.0 / max(3, model.nq))
    whole = _Part(
        np.vstack([np.zeros(3), origins, poses[-1, :3, 3]]),
        list(zip(numbers, origins, axes_of, strict=True)),
        list(zip(names, poses, strict=True)),
    )
    small = _small_end(np.vstack([origins, poses[-1, :3, 3]]), _NEAR * length)
    length = length if small is None else 0.145 * model.reach
    figure, axes = scene(4.6, 3.6) if small is None else scene(6.8, 4.2)
    _draw_base(axes, camera, length)
    _draw_line(axes, camera, whole.line, 8.0 if small is None else 5.0)
    notes = []
    if small is not None:
        whole, detail, zoom = _split(whole, small, length, camera)
        notes.append(_draw_detail(axes, camera, detail, zoom, length))
    notes.insert(0, _draw_part(axes, camera, whole, length))
    notes = [note for note in notes if note]
    if notes:
        axes.annotate(f"{'; '.join(notes)}: drawn next to their origin", (0.5, 0.0), (0, -6), "axes fraction",
                      "offset points", ha="center", va="top", fontsize=7.5, color=GREY)  # fmt: skip
    axes.autoscale_view()
    return figure


def _small_end(points: FloatArray, near: float) -> int | None:
    """Return the first of two or more outer joints that lie, like the tip, near it but not all in one place."""
    for index in range(1, len(points) - 2):
        distance = float(np.linalg.norm(points[index:] - points[index], axis=1).max())
        if 1e-9 * near < distance < near:
            return index
    return None


def _split(whole: _Part, start: int, length: float, camera: Camera) -> tuple[_Part, _Part, int]:
    """Return an arm without joints and frames of its small end, that end enlarged and moved aside, and by how much."""
    wrist = whole.joints[start][1]
    end = whole.line[start + 1 :]
    zoom = int(_LINK * length / np.abs(end - wrist).max())
    plane = camera.project(np.eye(3))  # its columns span the picture
    shift = plane @ _DETAIL * length

    def enlarge(point: FloatArray) -> FloatArray:
        larger: FloatArray = wrist + zoom * (point - wrist) + shift
        return larger

    def inside(pose: FloatArray) -> bool:
        return bool(np.linalg.norm(pose[:3, 3] - wrist) <= np.linalg.norm(end - wrist, axis=1).max() + 1e-9)

    below = wrist - whole.line[start]
    stub = wrist - 1.1 * length * below / max(float(np.linalg.norm(below)), 1e-12) / zoom
    moved = []
    for name, pose in whole.frames:
        if inside(pose):
            larger = pose.copy()
            larger[:3, 3] = enlarge(pose[:3, 3])
            moved.append((name, larger))
    detail = _Part(
        np.array([enlarge(point) for point in (stub, *end)]),
        [(number, enlarge(origin), axis) for number, origin, axis in whole.joints[start:]],
        moved,
        _DETAIL_ASIDE,
    )
    rest = replace(
        whole, joints=whole.joints[:start], frames=[(name, pose) for name, pose in whole.frames if not inside(pose)]
    )
    return rest, detail, zoom


def _draw_detail(axes: Axes, camera: Camera, part: _Part, zoom: int, length: float) -> str:
    """Draw the enlarged end in a circle, and the circle about the small one that it shows; return its note."""
    flat = camera.project(part.line[1:])
    centre = (flat.min(axis=0) + flat.max(axis=0)) / 2.0
    radius = float(np.linalg.norm(flat - centre, axis=1).max()) + 1.25 * length
    wrist = flat[0]
    small = wrist - _DETAIL * length + (centre - wrist) / zoom
    step = centre - small
    tangent = np.arctan2(step[1], step[0]) + np.array([1.0, -1.0]) * np.arccos(
        radius * (1.0 / zoom - 1.0) / np.linalg.norm(step)
    )
    normals = np.column_stack([np.cos(tangent), np.sin(tangent)])
    angle = np.linspace(0.0, 2.0 * np.pi, 120)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    for middle, r in ((small, radius / zoom), (centre, radius)):
        axes.plot(*(middle + r * ring).T, color=GREY, lw=0.7, zorder=1.4)
    for normal in normals:
        axes.plot(
            *np.array([small + radius / zoom * normal, centre + radius * normal]).T, color=GREY, lw=0.5, zorder=0.6
        )
    write(axes, centre - [0.0, radius + 0.3 * length], f"enlarged {zoom} times", size=7.5, color=GREY)
    _draw_line(axes, camera, part.line, 8.0)
    return _draw_part(axes, camera, part, length)


def _draw_part(axes: Axes, camera: Camera, part: _Part, length: float) -> str:
    """Draw joints and frames; return the names of frames drawn next to their place, as text."""
    for number, origin, axis in part.joints:
        _draw_joint(axes, camera, origin, axis, length, f"$q_{{{number}}}$")
    crowded = _draw_frames(axes, camera, part, length)
    return "; ".join(f"{'frames' if len(group) > 1 else 'frame'} {' and '.join(group)}" for group in crowded)


def _draw_base(axes: Axes, camera: Camera, length: float) -> None:
    foot = np.array([0.0, 0.0, -0.75 * length])
    axes.fill(*camera.project(circle(foot, np.array([0.0, 0.0, 1.0]), 0.75 * length)).T, color=PALE, zorder=0.5)
    _draw_line(axes, camera, np.vstack([foot, np.zeros(3)]), 8.0)


def _draw_line(axes: Axes, camera: Camera, points: FloatArray, width: float) -> None:
    flat = camera.project(points)
    axes.plot(*flat.T, color=PALE, lw=width, solid_capstyle="round", solid_joinstyle="round", zorder=1)


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


def _draw_frames(axes: Axes, camera: Camera, part: _Part, length: float) -> list[tuple[str, ...]]:
    """Draw all frames; return the names of those drawn next to their place, by place."""
    poses = np.array([pose for _, pose in part.frames])
    names = [name for name, _ in part.frames]
    middle = camera.project(part.line.max(axis=0) + part.line.min(axis=0)) / 2.0
    groups: list[list[int]] = []
    for index, origin in enumerate(poses[:, :3, 3]):
        near = [group for group in groups if np.linalg.norm(poses[group[0], :3, 3] - origin) < _NEAR * length]
        if near:
            near[0].append(index)
        else:
            groups.append([index])
    crowded = []
    for group in groups:
        place_3d = poses[group, :3, 3].mean(axis=0)
        joints = sum(bool(np.linalg.norm(origin - place_3d) < 1e-6 * length) for _, origin, _ in part.joints)
        beside = len(group) > 1 or joints > 1
        centre = camera.project(place_3d)
        away = -part.aside[0] if centre[0] <= middle[0] else part.aside[0]
        for rank, index in enumerate(group):
            above = part.aside[1] + _APART * ((len(group) - 1) / 2.0 - rank)
            at = camera.project(poses[index, :3, 3])
            place = centre + length * np.array([away, above]) if beside else at
            if beside:
                axes.plot(*np.column_stack([at, place]), color=GREY, lw=0.8, ls=":", zorder=1.5)
            axes.plot(*place, "o", ms=3, color=INK, zorder=6)
            triad(axes, camera, poses[index], place, length, names[index], 0.22 * length)
        if beside:
            crowded.append(tuple(names[index] for index in group))
    return crowded
