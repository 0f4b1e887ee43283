"""Workspace of an arm with its manipulability (thesis figures 2.3 and 2.4)."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from runner.base.arrays import FloatArray
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import GREY, INK, Camera, arrow, circle, drawing, triad, write
from runner.robots.workspace import Workspace

_SHOWN = 1000  # tip positions drawn in the sphere
_CELLS = 40  # of the cross-section, along its radius; each shows its best sample
_SINGULAR = palette.LIGHT[1]


@drawing
def workspace_sphere(workspace: Workspace) -> Figure:
    """Draw the sphere of reach with sampled tip positions, and its meridian cross-section by manipulability."""
    figure = Figure(figsize=(6.5, 3.3))
    _draw_sphere(figure.add_axes((0.0, 0.02, 0.5, 0.9)), workspace, Camera(35.0, 20.0))
    _draw_section(figure, figure.add_axes((0.58, 0.13, 0.27, 0.79)), workspace)
    return figure


def _draw_sphere(axes: Axes, workspace: Workspace, camera: Camera) -> None:
    axes.set_axis_off()
    axes.set_aspect("equal")
    radius, centre = workspace.outer, workspace.shoulder
    tips = camera.project(workspace.tips[:_SHOWN])
    axes.scatter(
        tips[:, 0], tips[:, 1], s=1.2, color=palette.LIGHT[0], alpha=0.45, linewidths=0, rasterized=True, zorder=2
    )
    angle = np.linspace(0.0, 2.0 * np.pi, 120)
    outline = camera.project(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    axes.plot(*outline.T, color=INK, lw=0.9, zorder=3)
    for normal in np.eye(3):
        ring = circle(centre, normal, radius)
        front = camera.nearness(ring - centre) >= 0.0
        for seen, style in ((front, "-"), (~front, (0, (3, 3)))):
            flat = np.where(seen[:, None], camera.project(ring), np.nan)
            axes.plot(*flat.T, color=GREY, lw=0.7, ls=style, zorder=3)
    triad(axes, camera, np.eye(4), camera.project(centre), 0.45 * radius, "", 0.09 * radius)
    direction = np.array([0.0, np.cos(0.6), -np.sin(0.6)])
    start, end = camera.project(centre), camera.project(centre + radius * direction)
    arrow(axes, start, end, INK)
    write(axes, 0.3 * start + 0.7 * end + radius * np.array([0.18, 0.03]), f"{radius:.4g} m")
    axes.set_title(f"{min(_SHOWN, len(workspace.tips))} of {len(workspace.tips)} random postures", fontsize=8.5)


def _draw_section(figure: Figure, axes: Axes, workspace: Workspace) -> None:
    r, z, w = _best_samples(workspace)
    near_axis = r < 0.04 * workspace.outer
    r, z, w = np.append(r, -r), np.append(z, z), np.append(w, w)  # mirrored, so that the axis lies inside
    outer, (_, _, height) = workspace.outer, workspace.shoulder
    mesh = Triangulation(r, z)
    corners = np.column_stack([r, z])[mesh.triangles]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    mesh.set_mask(edges.max(axis=1) > 4.0 * outer / _CELLS)
    filled = axes.tricontourf(mesh, w, levels=MaxNLocator(9).tick_values(0.0, w.max()), cmap="viridis")
    filled.set_rasterized(True)  # jagged outlines of many points: a picture of 10 kB instead of 150 kB of paths
    angle = np.linspace(-np.pi / 2.0, np.pi / 2.0, 90)
    cos, sin = np.cos(angle), np.sin(angle)
    red: dict[str, Any] = {"color": _SINGULAR, "lw": 1.8, "clip_on": False, "zorder": 4}
    axes.plot(outer * cos, height + outer * sin, label="stretched out", **red)
    if near_axis.any() and w[: len(near_axis)][near_axis].max() < 0.1 * w.max():
        axes.plot([0.0, 0.0], [height - outer, height + outer], ls=(0, (4, 2)), label="on the base axis", **red)
    if workspace.inner < 1e-3 * outer:
        axes.plot([0.0], [height], "o", ms=5, mfc="white", label="folded", **red)
    else:
        axes.plot(workspace.inner * cos, height + workspace.inner * sin, ls=":", label="folded", **red)
    axes.set_aspect("equal")
    axes.set(xlim=(0.0, outer * 1.04), ylim=(height - 1.04 * outer, height + 1.04 * outer))
    axes.set_xlabel("distance from the base axis (m)")
    axes.set_ylabel("$z$ (m)")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(title="singular", loc="upper left", bbox_to_anchor=(0.72, 1.04), frameon=False, fontsize=7.5,
                title_fontsize=7.5, alignment="left", handlelength=1.8)  # fmt: skip
    bar = figure.add_axes((0.9, 0.13, 0.018, 0.5))
    figure.colorbar(filled, cax=bar, format="%.2g").set_label("manipulability (m$^3$)")
    axes.set_title("Meridian section", fontsize=8.5, loc="left")


def _best_samples(workspace: Workspace) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return r, z and manipulability of the best sample in each cell of the half-plane, and of the axis."""
    x, y, z = (workspace.tips - [*workspace.shoulder[:2], 0.0]).T
    r, w = np.hypot(x, y), workspace.manipulability
    cell = workspace.outer / _CELLS
    keys = np.floor(r / cell).astype(int) + 4 * _CELLS * np.floor(z / cell).astype(int)
    order = np.argsort(w, kind="stable")[::-1]
    chosen = order[np.unique(keys[order], return_index=True)[1]]
    return r[chosen], z[chosen], w[chosen]
