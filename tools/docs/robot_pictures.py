"""The picture of the arms that labs own: each at home, drawn by the shapes of its file."""

import re
from collections.abc import Iterator

import numpy as np
import pinocchio as pin
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

from runner.assembly.validation import validate
from runner.base.arrays import FloatArray
from runner.config.compose.compose import compose
from runner.reporting.charts.canvas import GREY, INK, Camera, circle, drawing, scene, write
from runner.reporting.document import PlaybackBody
from runner.reporting.playback import playback_bodies

ARMS = ("panda", "fr3", "iiwa14", "gen3", "sawyer", "ur5e", "ur10e", "xarm7", "z1", "so101")
_SHADES = (("#e8ecf1", "#f4f6f9"), ("#9db6d3", "#b9cce2"))  # of a link's sides and ends, in turn
_WIDE, _HIGH, _COLUMNS = 0.92, 1.07, 5  # m, of the place of an arm

_ROUND = circle(np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0)[::3, :2]

Face = tuple[float, FloatArray, str]


def robots() -> str:
    """Draw the ten arms to one scale, but the SO-101 at twice its size."""
    # Tenths of a point, for a small file; the scale of letters keeps its digits.
    return re.sub(r"(?<!scale\(0)(\.\d)\d{5}\b", r"\1", _sheet())


@drawing
def _sheet() -> Figure:
    camera, rows = Camera(-35.0, 14.0), -(-len(ARMS) // _COLUMNS)
    figure, axes = scene(9.0, 9.0 * rows * _HIGH / (_COLUMNS * _WIDE))
    for number, name in enumerate(ARMS):
        arm = validate(compose((f"robot={name}", "plant=rk4"))).arm
        size = 2.0 if name == "so101" else 1.0
        bodies = playback_bodies(arm.urdf, arm.model, arm.home[None])
        faces = [face for body in bodies for face in _faces(body, camera)]
        outlines = np.vstack([outline for _, outline, _ in faces])
        row, column = divmod(number, _COLUMNS)
        middle = (outlines[:, 0].min() + outlines[:, 0].max()) / 2.0
        shift = np.array([column * _WIDE - size * middle, -row * _HIGH - size * outlines[:, 1].min()])
        for place, (_, outline, color) in enumerate(sorted(faces, key=lambda face: face[0])):
            axes.fill(*(size * outline + shift).T, fc=color, ec=INK, lw=0.3, zorder=2.0 + 1e-4 * place, clip_on=False)
        label = name if size == 1.0 else f"{name} (x {size:g})"
        write(axes, np.array([column * _WIDE, -row * _HIGH - 0.09]), label, halo=False)
    low = -(rows - 1) * _HIGH - 0.2
    axes.plot([-0.5, 0.0], [low, low], color=GREY, lw=1.2, solid_capstyle="butt")
    write(axes, np.array([0.13, low]), "0.5 m", size=7.5, color=GREY, halo=False)
    axes.set(xlim=(-0.5 * _WIDE, (_COLUMNS - 0.5) * _WIDE), ylim=(low - 0.06, _HIGH - 0.1))
    return figure


def _faces(body: PlaybackBody, camera: Camera) -> Iterator[Face]:
    """Yield what is seen of a body: nearness to the viewer, outline in the picture, shape (N, 2), and colour."""
    w, x, y, z = body.rotations[0]
    turn, shift = pin.Quaternion(w, x, y, z).matrix(), body.positions[0]
    side, end = _SHADES[body.color % 2]
    for first, last, radius in body.segments:
        ends = np.array([first, last]) @ turn.T + shift
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        rims = [camera.project(circle(centre, along, radius)[::3]) for centre in ends]
        both, nearness = np.vstack(rims), float(camera.nearness(ends.mean(axis=0)))
        yield nearness, both[ConvexHull(both).vertices], side
        yield nearness + 1e-6, rims[int(camera.nearness(along) > 0.0)], end
    for centre, radius in body.balls:
        at = np.asarray(centre) @ turn.T + shift
        yield float(camera.nearness(at)), camera.project(at) + radius * _ROUND, side
