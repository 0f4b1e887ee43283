"""Rules for the picture of every control graph."""

import functools
import itertools
import sys

import matplotlib as mpl
import numpy as np
from matplotlib.mathtext import MathTextParser

from runner.papers.studies.thesis.diagrams.block_diagram import (
    ControlGraph,
    _box,
    _route,
    _structures,
    _text_width,
    block_diagram,
)
from runner.reporting.charts import canvas

# The same few strings are in all graphs; each is set once.
MathTextParser._parse_cached = functools.cache(MathTextParser._parse_cached.__wrapped__)
sys.modules["runner.papers.studies.thesis.diagrams.block_diagram"]._text_width = functools.cache(_text_width)


def joined(*names):
    """Return the graph of some parts of control_structures.yaml."""
    parts = [_structures().parts[name] for name in names]
    return ControlGraph(*(tuple(each for part in parts for each in getattr(part, kind)) for kind in ("nodes", "edges")))


def check_structure(graph):
    kinds = {node.name: node.kind for node in graph.nodes}
    assert len(kinds) == len(graph.nodes)
    fed = {edge.target for edge in graph.edges}
    assert fed | {edge.source for edge in graph.edges} == set(kinds)
    assert {name for name, kind in kinds.items() if kind == "source"} == set(kinds) - fed
    assert all((edge.sign != "") == (kinds[edge.target] == "sum") for edge in graph.edges)


def assert_loop_closed(graph, name):
    """Assert that signals that leave a node come back to it."""
    reached, frontier = set(), {name}
    while frontier:
        frontier = {edge.target for edge in graph.edges if edge.source in frontier} - reached
        reached |= frontier
    assert name in reached


def check_ways(graph):
    """Signals run along rows and columns, through no foreign block, and cross no signal of another source."""
    boxes = {node.name: _box(node) for node in graph.nodes}
    routes = [_route(edge, boxes) for edge in graph.edges]
    for edge, route in zip(graph.edges, routes, strict=True):
        steps = np.abs(np.diff(route, axis=0))
        assert np.all(steps.min(axis=1) < 1e-9), edge
        assert np.all(steps.max(axis=1) > 0.05), edge
        for name, box in boxes.items():
            for low, high in spans(route):
                outside = np.any((high <= box.centre - box.half + 1e-9) | (low >= box.centre + box.half - 1e-9))
                assert outside, f"{edge.source} to {edge.target} runs through {name}"
    for (one, way), (other, other_way) in itertools.combinations(zip(graph.edges, routes, strict=True), 2):
        if one.source != other.source and one.target != other.target:
            assert not any(overlap(a, b, 0.0) for a, b in itertools.product(spans(way), spans(other_way))), (one, other)
    for one, other in itertools.combinations(boxes.values(), 2):
        assert np.any(np.abs(one.centre - other.centre) > one.half + other.half + 0.02)


def check_texts(graph):
    """Labels are in their own block, or free of all blocks, lines and other labels; nothing is cut off."""
    boxes = {node.name: _box(node) for node in graph.nodes}
    labels = {node.label for node in graph.nodes}
    lines = [span for edge in graph.edges for span in spans(_route(edge, boxes))]
    with mpl.rc_context(canvas._STYLE):
        figure = block_diagram.__wrapped__(graph)
        axes = figure.axes[0]
        texts = [(text.get_text(), extent(axes, text)) for text in axes.texts if text.get_text()]
    limits = np.array([axes.get_xlim(), axes.get_ylim()]).T
    assert all(np.all(low >= limits[0]) and np.all(high <= limits[1]) for low, high in lines)
    free = [(text, area) for text, area in texts if text not in labels]
    for text, area in free:
        assert np.all(area[0] >= limits[0] - 0.02), text
        assert np.all(area[1] <= limits[1] + 0.02), text
        assert not any(overlap(area, line, -0.004) for line in lines), f"{text} on a line"
        for box in boxes.values():
            assert not overlap(area, (box.centre - box.half, box.centre + box.half), 0.0), f"{text} on a block"
    for (one, area), (other, other_area) in itertools.combinations(free, 2):
        assert not overlap(area, other_area, 0.0), f"{one} on {other}"
    for text, (low, high) in texts:
        if text in labels:
            assert any(
                np.all(low >= box.centre - box.half) and np.all(high <= box.centre + box.half)
                for box in boxes.values()
            ), f"{text} leaves its block"  # fmt: skip


def spans(route):
    return [(np.minimum(a, b), np.maximum(a, b)) for a, b in itertools.pairwise(route)]


def overlap(one, other, tolerance):
    return bool(np.all(one[0] <= other[1] + tolerance) and np.all(other[0] <= one[1] + tolerance))


def extent(axes, text):
    corners = axes.transData.inverted().transform(text.get_window_extent())
    return corners.min(axis=0), corners.max(axis=0)
