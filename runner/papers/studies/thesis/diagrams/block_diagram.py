"""Control structures as directed graphs, and their block diagrams (thesis figures 3.4, 3.7, 5.2, 5.4 to 5.7, 5.9)."""

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Circle, FancyBboxPatch, Polygon
from matplotlib.textpath import TextPath

from runner.base.arrays import FloatArray
from runner.base.data_file import read_data
from runner.reporting.charts import palette
from runner.reporting.charts.canvas import INK, arrow, drawing, scene, write

Side = Literal["left", "right", "top", "bottom"]


@dataclass(frozen=True)
class Node:
    """A block, a question with several answers, a summing point, or a signal from outside the loop.

    Attributes:
        name: Name of the node in the graph.
        kind: Type of the node.
        label: Label, with mathematics between dollar signs (matplotlib's mathtext).
        column: Position along the signal path, left to right.
        row: Position across the signal path, top to bottom; the main path has row 0.
        rows: Number of rows that the node spans, centred on `row`.
        size: Least width and height, in inches.
    """

    name: str
    kind: Literal["block", "decision", "sum", "source"]
    column: float
    row: float
    label: str = ""
    rows: int = 1
    size: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Edge:
    """A signal from one node to another.

    Attributes:
        source: Name of the node that the edge leaves.
        target: Name of the node that the edge enters.
        label: Symbol of the signal, or "" if another edge of the same signal shows it.
        sign: Sign at a summing point.
        leave: Side on which the edge leaves.
        enter: Side on which the edge enters.
        lane: Row along which the edge runs if it leaves and enters by top or bottom, or column if it does by left or
            right; None for a direct path.
    """

    source: str
    target: str
    label: str = ""
    sign: Literal["", "+", "-"] = ""
    leave: Side = "right"
    enter: Side = "left"
    lane: float | None = None


@dataclass(frozen=True)
class ControlGraph:
    """A control structure.

    Attributes:
        nodes: Blocks, summing points and sources.
        edges: Signals between the nodes.
    """

    nodes: tuple[Node, ...] = ()
    edges: tuple[Edge, ...] = ()


@dataclass(frozen=True)
class Diagram:
    """A diagram of the thesis.

    Attributes:
        words: Description of the picture.
        parts: Names of the parts that make up its graph.
    """

    words: str
    parts: tuple[str, ...]


@dataclass(frozen=True)
class _Structures:
    """Content of control_structures.yaml: diagrams by figure, and parts by name."""

    diagrams: dict[str, Diagram]
    parts: dict[str, ControlGraph]


@cache
def _structures() -> _Structures:
    return read_data(Path(__file__).with_name("control_structures.yaml"), _Structures)


def describe(figure: str) -> str:
    """Return the description of a diagram, by its figure."""
    return _structures().diagrams[figure].words


def control_graph(figure: str) -> ControlGraph:
    """Return the control structure of a figure of the thesis, such as "figure 5.4"."""
    parts = [_structures().parts[name] for name in _structures().diagrams[figure].parts]
    return ControlGraph(*(tuple(each for part in parts for each in getattr(part, kind)) for kind in ("nodes", "edges")))


# Measures in inches, at the size on paper.
_COLUMN, _ROW = 0.64, 0.56
_RADIUS = 0.085
_PADDING = 0.08
_FONT = 8.5
_OUTWARDS = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "top": (0.0, 1.0), "bottom": (0.0, -1.0)}
_SIGN_PLACE = {"left": (-0.1, 0.1), "right": (0.1, 0.1), "top": (0.11, 0.08), "bottom": (0.11, -0.08)}


@dataclass(frozen=True)
class _Box:
    """Place of a node: centre and half of its size."""

    centre: FloatArray
    half: FloatArray

    def side(self, side: Side) -> FloatArray:
        return self.centre + self.half * _OUTWARDS[side]


@drawing
def block_diagram(graph: ControlGraph) -> Figure:
    """Draw a control structure: blocks, summing points with signs, and signals along rows and columns."""
    boxes = {node.name: _box(node) for node in graph.nodes}
    routes = {edge: _route(edge, boxes) for edge in graph.edges}
    corners = [box.centre + sign * box.half for box in boxes.values() for sign in (-1.0, 1.0)]
    drawn = np.vstack([*corners, *routes.values()])
    low, high = drawn.min(axis=0) - 0.15, drawn.max(axis=0) + 0.15
    figure, axes = scene(*(high - low))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    for edge, route in routes.items():
        for start, end in pairwise(route[:-1]):
            axes.plot(*np.column_stack([start, end]), color=INK, lw=0.9, solid_capstyle="round", zorder=1)
        arrow(axes, route[-2], route[-1], INK, 0.9, 2.0)
        _write_label(axes, edge, route)
        if edge.lane is not None and any(_same_wire(edge, other, routes) for other in graph.edges):
            axes.plot(*route[-2], "o", ms=3, color=INK, zorder=3)
    for node in graph.nodes:
        _draw_node(axes, node, boxes[node.name])
    return figure


def _box(node: Node) -> _Box:
    centre = np.array([node.column * _COLUMN, -node.row * _ROW])
    if node.kind == "sum":
        return _Box(centre, np.full(2, _RADIUS))
    lines = node.label.split("\n")
    width = max(_text_width(line) for line in lines)
    height = 0.3 + 0.15 * (len(lines) - 1) + (node.rows - 1) * _ROW
    return _Box(centre, np.maximum([max(width / 2.0 + _PADDING, 0.17), height / 2.0], np.array(node.size) / 2.0))


def _text_width(text: str) -> float:
    extents = TextPath((0.0, 0.0), text, size=_FONT, prop=FontProperties(math_fontfamily="stix")).get_extents()
    return float(extents.width) / 72.0


def _route(edge: Edge, boxes: dict[str, _Box]) -> FloatArray:
    """Return the corners of a signal's way, shape (N, 2)."""
    source, target = boxes[edge.source], boxes[edge.target]
    start, end = source.side(edge.leave), target.side(edge.enter)
    across = edge.leave in ("left", "right")
    if edge.lane is not None:
        lane = edge.lane * _COLUMN if across else -edge.lane * _ROW
        bends = [[lane, start[1]], [lane, end[1]]] if across else [[start[0], lane], [end[0], lane]]
        return np.array([start, *bends, end])
    if across == (edge.enter in ("left", "right")):
        if across and abs(end[1] - source.centre[1]) < source.half[1]:
            start = np.array([start[0], end[1]])  # a tall block sends each signal out at its target's height
        if np.abs(end - start).min() < 1e-9:
            return np.array([start, end])
        middle = (start + end) / 2.0
        bends = [[middle[0], start[1]], [middle[0], end[1]]] if across else [[start[0], middle[1]], [end[0], middle[1]]]
        return np.array([start, *bends, end])
    return np.array([start, [end[0], start[1]] if across else [start[0], end[1]], end])


def _same_wire(edge: Edge, other: Edge, routes: dict[Edge, FloatArray]) -> bool:
    """Return True if another signal leaves with this one and continues beyond the point where this one turns off."""
    if other is edge or (other.source, other.leave) != (edge.source, edge.leave):
        return False
    start, turn = routes[edge][1], routes[edge][2]
    along = (routes[other][:, 0] - start[0]) * np.sign(turn[0] - start[0])
    level = np.abs(routes[other][:, 1] - turn[1]) < 1e-9
    return bool(np.any(level & (along > abs(turn[0] - start[0]) + 1e-9)))


def _write_label(axes: Axes, edge: Edge, route: FloatArray) -> None:
    if edge.sign:
        place = route[-1] + _SIGN_PLACE[edge.enter]
        write(axes, place, "+" if edge.sign == "+" else "\u2212", 8.0, halo=False)
    if not edge.label:
        return
    start, end = max(pairwise(route), key=lambda pair: abs(float(pair[1][0] - pair[0][0])))
    length = abs(end[0] - start[0])
    if length == 0.0:
        write(axes, (start + end) / 2.0 + [0.17, 0.02], edge.label, _FONT, halo=False)
        return
    room = length if len(route) == 2 else min(length, 2.0)  # a long way has its label near its source
    if edge.sign and edge.enter == "left" and len(route) == 2:
        room = min(room - 0.18, 0.8)  # leave the sign its place
    x = start[0] + np.sign(end[0] - start[0]) * room / 2.0
    axes.text(x, start[1] + 0.045, edge.label, ha="center", va="bottom", fontsize=_FONT, zorder=4)


def _draw_node(axes: Axes, node: Node, box: _Box) -> None:
    if node.kind == "sum":
        axes.add_patch(Circle((box.centre[0], box.centre[1]), _RADIUS, fc="white", ec=INK, lw=0.9, zorder=3))
        return
    style = f"round,pad=0,rounding_size={0.1 if node.kind == 'source' else 0.02}"
    low, size = box.centre - box.half, 2.0 * box.half
    color, edge = ("#eef3fa", palette.LIGHT[0]) if node.kind == "block" else ("#fbf3e2", palette.LIGHT[3])
    if node.kind == "decision":
        outline = [box.side(side) for side in ("left", "top", "right", "bottom")]
        axes.add_patch(Polygon(outline, fc=color, ec=edge, lw=0.9, zorder=3))
    else:
        axes.add_patch(
            FancyBboxPatch((low[0], low[1]), size[0], size[1], boxstyle=style, fc=color, ec=edge, lw=0.9, zorder=3)
        )
    write(axes, box.centre, node.label, _FONT, halo=False)
