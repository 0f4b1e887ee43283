"""Heat maps over two axes, and small multiples over three."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from runner.reporting.document import Block, Map, Maps, Section, Text
from runner.reporting.sweep import theory
from runner.reporting.sweep.subject import Subject, axis_label, spans_decades, value_name, value_names
from runner.sweeps.measurements import Axis, FloatArray

_FEWEST_FOR_CONTOURS = 3
_MOST_MULTIPLES = 9
_MOST_POINTED = 5000  # cells that tell about themselves; a page with more would be slow


def section(subject: Subject) -> Section:
    """Return the maps of a sweep over two axes or more."""
    axes = _chosen(subject)
    blocks: list[Block] = []
    others = [axis.name for axis in subject.axes if axis not in axes]
    if others:
        blocks.append(
            Text(
                f"Shown are the three axes that explain most of {subject.metrics[0]}; over {', '.join(others)} the "
                "median is taken.".replace("$", "$$")
            )
        )
    for metric in subject.metrics:
        if np.isfinite(subject.medians[metric]).any():
            blocks.append(_maps(subject, metric, axes))
    blocks += theory.explained(axes[:2])
    return Section("Maps", blocks)


def _chosen(subject: Subject) -> list[Axis]:
    """Return the axes of the maps: horizontal, vertical, and where there are more that of the multiples."""
    if len(subject.axes) <= 2:
        return list(subject.axes)
    effects = subject.effects[subject.metrics[0]].effects
    share = {effect.axes[0]: effect.share for effect in effects if len(effect.axes) == 1}
    strongest = sorted(subject.axes, key=lambda axis: -share[axis.name])[:3]
    # The one with fewest values makes the multiples.
    multiple = min(strongest, key=lambda axis: len(axis.values))
    return [*(axis for axis in strongest if axis is not multiple), multiple]


def _maps(subject: Subject, metric: str, axes: list[Axis]) -> Maps:
    medians, columns = subject.medians[metric], 1
    if len(axes) == 2:
        cells = _map(subject, metric, axes[0], axes[1], range(len(medians)), "")
        panels = [cells]
        if metric == subject.metrics[0] and _has_contours(axes[0], axes[1], cells.values):
            panels.append(replace(cells, contours=True))
        what = "Median of each cell, and lines of equal value" if len(panels) > 1 else "Median of each cell"
    else:
        multiple = axes[2]
        levels = np.unique(np.linspace(0, len(multiple.values) - 1, _MOST_MULTIPLES).round().astype(int))
        panels = [
            _map(subject, metric, axes[0], axes[1], np.flatnonzero(multiple.level == level).tolist(),
                 f"{multiple.name} = {value_name(multiple, level)}")
            for level in levels.tolist()
        ]  # fmt: skip
        columns = min(3, len(panels))
        what = f"Median of each cell, a map for each value of {multiple.name}"
    crosses = " A cross marks failed runs." if any(panel.failed.any() for panel in panels) else ""
    caption = f"{what}: {metric}.{crosses}".replace("$", "$$")
    return Maps(caption, subject.label(metric), panels, spans_decades(medians), columns)


def _map(subject: Subject, metric: str, x: Axis, y: Axis, cells: Sequence[int], title: str) -> Map:
    shape = (len(y.values), len(x.values))
    members: list[list[int]] = [[] for _ in range(shape[0] * shape[1])]
    for cell in cells:
        members[int(y.level[cell]) * shape[1] + int(x.level[cell])].append(cell)
    medians, statuses = subject.medians[metric], subject.measurements.statuses
    single = all(len(some) == 1 for some in members)
    values = np.array([medians[some[0]] if single else _median(medians[some]) for some in members]).reshape(shape)
    failed = np.array([any(statuses[cell] != "ok" for cell in some) for some in members]).reshape(shape)
    pointed = [some[0] for some in members] if single and len(medians) <= _MOST_POINTED else []
    return Map(
        title,
        axis_label(x),
        axis_label(y),
        value_names(x),
        value_names(y),
        values,
        failed,
        theory.lines(x, y),
        hints=subject.hints(pointed),
        runs=subject.hashes(pointed),
    )


def _median(values: FloatArray) -> float:
    present = values[~np.isnan(values)]
    return float(np.median(present)) if present.size else float("nan")


def _has_contours(x: Axis, y: Axis, values: FloatArray) -> bool:
    finite = values[np.isfinite(values)]
    return (
        x.numbers is not None
        and y.numbers is not None
        and min(values.shape) >= _FEWEST_FOR_CONTOURS
        and 2 * finite.size > values.size
        and bool(finite.min() < finite.max())
    )
