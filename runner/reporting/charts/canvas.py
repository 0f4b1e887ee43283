"""Drawing tools shared by all drawings: style, SVG output and a three-dimensional view."""

import functools
import io
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ParamSpec

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from runner.base.arrays import FloatArray
from runner.reporting.charts import palette
from runner.reporting.charts.sheet import LINES

INK, GREY, PALE = "#20242a", "#7d8590", "#d3d8de"
AXIS_COLORS = (palette.LIGHT[1], palette.LIGHT[2], palette.LIGHT[0])
"""Colours of the x, y and z axes of a frame."""

_STYLE: Any = {
    **LINES,
    "font.size": 8,
    "axes.labelcolor": INK,
    "text.color": INK,
    "mathtext.fontset": "stix",
}

_ASIDE = np.array([[0.6, -0.8], [0.8, 0.6]])  # turns an arrow's direction to the place of its label, next to the head

_PATH, _DIGITS = re.compile(r' d="[^"]*"'), re.compile(r"(\.\d)\d+")  # a tenth of a point is not seen

P = ParamSpec("P")


def drawing(make: Callable[P, Figure]) -> Callable[P, str]:
    """Turn a function that makes a figure into one that returns it as SVG; equal arguments give equal text."""

    @functools.wraps(make)
    def draw(*args: P.args, **kwargs: P.kwargs) -> str:
        with mpl.rc_context(_STYLE):
            stream = io.StringIO()
            make(*args, **kwargs).savefig(
                stream,
                format="svg",
                dpi=150,
                bbox_inches="tight",
                pad_inches=0.04,
                metadata={"Date": None, "Creator": None},
            )
        return _PATH.sub(lambda path: _DIGITS.sub(r"\1", path[0]), stream.getvalue())

    return draw


@dataclass(frozen=True)
class Camera:
    """A parallel projection: the z axis is upright, the viewer is far away in the given direction.

    Attributes:
        azimuth: Direction of the viewer about z, from x towards y, in deg.
        elevation: Height of the viewer above the horizon, in deg.
    """

    azimuth: float = 30.0
    elevation: float = 20.0

    def project(self, points: FloatArray) -> FloatArray:
        """Return the picture of points (or directions), shape (..., 3) to (..., 2): rightwards and upwards."""
        a, e = np.radians([self.azimuth, self.elevation])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        up = np.array([-np.cos(a) * np.sin(e), -np.sin(a) * np.sin(e), np.cos(e)])
        return np.asarray(np.asarray(points) @ np.column_stack([right, up]))

    def nearness(self, points: FloatArray) -> FloatArray:
        """Return the distance of points towards the viewer, shape (..., 3) to (...)."""
        a, e = np.radians([self.azimuth, self.elevation])
        return np.asarray(np.asarray(points) @ [np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])


def scene(width: float, height: float) -> tuple[Figure, Axes]:
    """Return an empty figure of a size in inches, and its axes: to scale, without frame or ticks."""
    figure = Figure(figsize=(width, height))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_aspect("equal")
    return figure, axes


def circle(centre: FloatArray, normal: FloatArray, radius: float, turn: float = 1.0) -> FloatArray:
    """Return points of a circle (or of the given part of a turn) about an axis, shape (N, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(normal))]
    u = np.cross(normal, helper)
    u = u / np.linalg.norm(u)
    v = np.cross(normal, u)
    angle = np.linspace(0.0, 2.0 * np.pi * turn, max(8, int(72 * turn)))[:, None]
    points: FloatArray = centre + radius * (np.cos(angle) * u + np.sin(angle) * v)
    return points


def arrow(axes: Axes, start: FloatArray, end: FloatArray, color: str, width: float = 1.0, z: float = 3.0) -> None:
    """Draw an arrow between two points of the picture."""
    properties = {"arrowstyle": "-|>,head_width=0.18,head_length=0.4", "color": color, "lw": width}
    axes.annotate(
        "",
        pair(end),
        pair(start),
        arrowprops={**properties, "shrinkA": 0, "shrinkB": 0},
        annotation_clip=False,
        zorder=z,
    )
    axes.update_datalim([pair(start), pair(end)])


def write(axes: Axes, place: FloatArray, text: str, size: float = 9.0, color: str = INK, halo: bool = True) -> None:
    """Write a string centred at a place of the picture; a halo keeps it legible on a line."""
    effects = [withStroke(linewidth=2.0, foreground="white")] if halo else []
    x, y = pair(place)
    axes.text(x, y, text, color=color, fontsize=size, ha="center", va="center", zorder=6, path_effects=effects)


def pair(point: FloatArray) -> tuple[float, float]:
    """Return a point of the picture, shape (2,), as the two numbers that matplotlib asks for."""
    x, y = (float(value) for value in point)
    return x, y


def triad(axes: Axes, camera: Camera, pose: FloatArray, at: FloatArray, length: float, name: str, gap: float) -> None:
    """Draw the axes of a frame with their labels.

    Args:
        axes: Where to draw.
        camera: The view.
        pose: Pose of the frame, shape (4, 4); only its rotation counts.
        at: Place of its origin in the picture, shape (2,).
        length: Length of the axes, in m.
        name: The frame's number, the index of its labels.
        gap: Distance of a label from the head of its arrow, in m.
    """
    for letter, direction, color in zip("xyz", pose[:3, :3].T, AXIS_COLORS, strict=True):
        flat = camera.project(direction)
        end = at + length * flat
        arrow(axes, at, end, color, 1.3, 5.0)
        sideways = _ASIDE @ flat / max(float(np.linalg.norm(flat)), 0.3)
        label = f"${letter}_{{{name}}}$" if name else f"${letter}$"
        write(axes, end + gap * sideways, label, color=color)
