"""Heat maps over two axes, with small multiples for further axes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting import metric_titles
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.document import Block, Map, Maps, Section
from runner.reporting.markup import literal
from runner.reporting.sweep import theory
from runner.reporting.sweep.subject import Subject, axis_label, spans_decades, value_names
from runner.sweeps.measurements import Axis

POOLED = "seed"  # the one axis over which maps take a median: its values mean nothing
_FEWEST_FOR_CONTOURS = 3
_MOST_MULTIPLES = 9
_MOST_VALUES = 200  # of an axis of a map
_MOST_POINTED = 5000  # cells that tell about themselves; a page with more would be slow


def section(subject: Subject) -> Section:
    """Return the maps of a sweep over two axes or more, in which every value is that of one cell."""
    x, y, *others = choose_axes(subject)
    blocks: list[Block] = [
        _maps(subject, metric, x, y, others) for metric in subject.metrics if np.isfinite(subject.medians[metric]).any()
    ]
    return Section("Maps", [*blocks, *theory.explained([x, y])])


def is_readable(subject: Subject) -> bool:
    """Tell whether maps of a sweep can be read: over two axes or more, and of few enough values."""
    return len(subject.axes) > 1 and all(len(axis.values) <= _MOST_VALUES for axis in choose_axes(subject)[:2])


def choose_axes(subject: Subject) -> list[Axis]:
    """Return the axes of the maps: horizontal, vertical, and where there are more those of the multiples."""
    axes = [axis for axis in subject.axes if axis.name != POOLED]
    if len(axes) < 2:
        return list(subject.axes)
    if len(axes) == 2:
        return axes
    effects = subject.effects[subject.metrics[0]].effects
    share = {effect.axes[0]: effect.share for effect in effects if len(effect.axes) == 1}
    ordered = sorted(axes, key=lambda axis: -share[axis.name])
    numbers = [axis for axis in ordered if axis.numbers is not None]
    if len(numbers) == 2:  # a map of each arm, task or law
        return [*numbers, *(axis for axis in ordered if axis.numbers is None)]
    if len(numbers) > 2:
        ordered = [*numbers, *(axis for axis in ordered if axis.numbers is None)]
    # Of the three that explain most the one with fewest values makes the multiples.
    multiple = min(ordered[:3], key=lambda axis: len(axis.values))
    return [*(axis for axis in ordered[:3] if axis is not multiple), multiple, *ordered[3:]]


def _maps(subject: Subject, metric: str, x: Axis, y: Axis, others: Sequence[Axis]) -> Maps:
    """Return a map for each combination of the values of the other axes, as tasks or arms are not to be averaged."""
    of = medians, low, _ = subject.medians[metric], *subject.ends(metric)
    columns = 1
    pooled = next((axis for axis in subject.axes if axis.name == POOLED and axis not in (x, y)), None)
    what = "Median of each cell" if pooled is None else (
        f"Of the medians of the cells of {len(pooled.values)} seeds the middle one, of an even number the lower"
    )  # fmt: skip
    if not others:
        cells = _map(subject, of, x, y, range(len(medians)), "")
        panels = [cells]
        if metric == subject.metrics[0] and _has_contours(x, y, cells.values):
            panels.append(replace(cells, contours=True))
            what += ", and lines of equal value"
    else:
        levels = np.column_stack([axis.level for axis in others])
        combinations = np.unique(levels, axis=0)
        shown = spaced_indices(len(combinations), _MOST_MULTIPLES)
        panels = [
            _map(subject, of, x, y, np.flatnonzero((levels == some).all(axis=1)).tolist(),
                 ", ".join(f"{axis.name} = {axis.text(int(level))}"
                           for axis, level in zip(others, some, strict=True)))
            for some in combinations[shown]
        ]  # fmt: skip
        columns = min(3 if len(others) == 1 else 2, len(panels))
        names = " and ".join(axis.name for axis in others)
        what += f", a map for each value of {names}"
        if len(shown) < len(combinations):
            what += f" ({len(shown)} of {len(combinations)}, evenly chosen; All runs has the others)"
    crosses = " A cross marks failed runs." if any(panel.failed.any() for panel in panels) else ""
    scale = " The colours span the 95 % intervals of the medians." if np.isfinite(low).any() else ""
    caption = literal(f"{what}: {metric_titles.title(metric)}.{crosses}{scale}")
    return Maps(caption, subject.label(metric), panels, spans_decades(medians), columns)


def _map(subject: Subject, of: Sequence[FloatArray], x: Axis, y: Axis, cells: Sequence[int], title: str) -> Map:
    """Return a map of some cells; `of` has the median of each cell and the ends of its interval."""
    shape = (len(y.values), len(x.values))
    members: list[list[int]] = [[] for _ in range(shape[0] * shape[1])]
    for cell in cells:
        members[int(y.level[cell]) * shape[1] + int(x.level[cell])].append(cell)
    statuses = subject.measurements.statuses
    single = all(len(some) == 1 for some in members)
    values, low, high = (
        np.array([each[some[0]] if single else _median(each[some]) for some in members]).reshape(shape) for each in of
    )
    failed = np.array([any(statuses[cell] != "ok" for cell in some) for some in members]).reshape(shape)
    pointed = [some[0] for some in members] if single and len(statuses) <= _MOST_POINTED else []
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
        low=low,
        high=high,
    )


def _median(values: FloatArray) -> float:
    """Return the middle one of some values, of an even number the lower: a value that one of the cells has."""
    present = values[~np.isnan(values)]
    return float(np.quantile(present, 0.5, method="inverted_cdf")) if present.size else float("nan")


def _has_contours(x: Axis, y: Axis, values: FloatArray) -> bool:
    finite = values[np.isfinite(values)]
    return (
        x.numbers is not None
        and y.numbers is not None
        and min(values.shape) >= _FEWEST_FOR_CONTOURS
        and 2 * finite.size > values.size
        and bool(finite.min() < finite.max())
    )
