"""Control structure as a directed graph, for block diagrams."""

from dataclasses import dataclass
from typing import Literal

Side = Literal["left", "right", "top", "bottom"]


@dataclass(frozen=True)
class Node:
    """A block, a summing point, or a signal from outside the loop.

    Attributes:
        name: Name of the node in the graph.
        kind: Type of the node.
        label: Label, with mathematics between dollar signs (matplotlib's mathtext).
        column: Position along the signal path, left to right.
        row: Position across the signal path, top to bottom; the main path has row 0.
        rows: Number of rows that the node spans, centred on `row`.
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
        source: Name of the node that the edge leaves.
        target: Name of the node that the edge enters.
        label: Symbol of the signal, or "" if another edge of the same signal shows it.
        sign: Sign at a summing point.
        leave: Side on which the edge leaves.
        enter: Side on which the edge enters.
        lane: Row along which the edge runs if it leaves and enters by top or bottom; None for a direct path.
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

    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
