"""Control structure as a directed graph, for block diagrams."""

from dataclasses import dataclass
from typing import Literal

Side = Literal["left", "right", "top", "bottom"]


@dataclass(frozen=True)
class Node:
    """A block, a summing point, or a signal that comes from outside the loop.

    Attributes:
        name: Its name in the graph.
        kind: What it is.
        label: Its text, with mathematics between dollar signs (matplotlib's mathtext).
        column: Place along the signal's way, left to right.
        row: Place across it, top to bottom; the main path has row 0.
        rows: How many rows it spans, centred on its own.
    """

    name: str
    kind: Literal["block", "sum", "source"]
    label: str
    column: float
    row: float
    rows: int = 1


@dataclass(frozen=True)
class Edge:
    """A signal from one node to another.

    Attributes:
        source: Name of the node it leaves.
        target: Name of the node it enters.
        label: Its symbol, or "" where another edge of the same signal bears it.
        sign: How it enters a summing point.
        leave: The side on which it leaves.
        enter: The side on which it enters.
        lane: Row along which it runs, where it leaves and enters by top or bottom; None for a direct way.
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
        nodes: Its blocks, summing points and sources.
        edges: The signals between them.
    """

    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
