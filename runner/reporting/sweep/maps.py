"""Heat maps over two axes, with small multiples for further axes and the stability limit of theory."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.reporting import metric_titles
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.document import Formula, Map, Maps, ReportBlock, Section, Series, Text
from runner.reporting.markup import literal
from runner.reporting.sweep.subject import Subject, key_label, spans_decades
from runner.store.axes import Axis, group_cells

POOLED = "seed"  # the one axis over which maps take a median: its values mean nothing
_FEWEST_FOR_CONTOURS = 3
_MOST_MULTIPLES = 9
_MOST_VALUES = 200  # of an axis of a map
_MOST_POINTED = 5000  # cells with a hint at the pointer; a page with more would be slow
_FREQUENCY, _PERIOD = "controller.natural_frequency", "controller.period"
_POINTS = 400


def section(subject: Subject) -> Section:
    """Return the maps of a sweep over two axes or more, in which every value is that of one cell."""
    x, y, *others = choose_axes(subject)
    blocks: list[ReportBlock] = [
        _maps(subject, metric, x, y, others) for metric in subject.metrics if np.isfinite(subject.medians[metric]).any()
    ]
    return Section("Maps", [*blocks, *theory_text([x, y])])


def is_readable(subject: Subject) -> bool:
    """Return True if maps of a sweep can be read: over two axes or more, and of few enough values."""
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
    """Return a map for each combination of the values of the other axes, because tasks or arms must not be averaged."""
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
        combinations = named_groups(others, len(medians))
        shown = spaced_indices(len(combinations), _MOST_MULTIPLES)
        panels = [_map(subject, of, x, y, cells.tolist(), name)
                  for name, cells in (combinations[place] for place in shown)]  # fmt: skip
        columns = min(3 if len(others) == 1 else 2, len(panels))
        names = " and ".join(axis.name for axis in others)
        what += f", a map for each value of {names}"
        if len(shown) < len(combinations):
            what += f" ({len(shown)} of {len(combinations)}, evenly chosen; All runs has the others)"
    crosses = " A cross marks failed runs." if any(panel.failed.any() for panel in panels) else ""
    scale = " The colours span the 95 % intervals of the medians." if np.isfinite(low).any() else ""
    caption = literal(f"{what}: {metric_titles.title(metric)}.{crosses}{scale}")
    return Maps(caption, subject.label(metric), panels, spans_decades(medians), columns)


def named_groups(axes: Sequence[Axis], count: int) -> list[tuple[str, NDArray[np.intp]]]:
    """Return the name of each combination of the levels of some axes, such as "robot = macro", and its cells.

    Args:
        axes: The axes.
        count: Number of all cells.
    """
    return [
        (", ".join(f"{axis.name} = {axis.text(level)}" for axis, level in zip(axes, levels, strict=True)), cells)
        for levels, cells in group_cells(axes, np.arange(count))
    ]


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
        key_label(x),
        key_label(y),
        x.texts,
        y.texts,
        values,
        failed,
        theory_lines(x, y),
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


def theory_lines(x: Axis, y: Axis) -> list[Series]:
    """Return the lines over a map: omega_n h = 1 over natural frequency and sample time.

    Coordinates count columns and rows from 0; between two of them a value lies where its logarithm does.
    """
    if not _sampling(x, y) or x.numbers is None or y.numbers is None:
        return []
    across = np.geomspace(x.numbers[0], x.numbers[-1], _POINTS)
    upwards = 1.0 / across
    inside = (upwards >= y.numbers[0]) & (upwards <= y.numbers[-1])
    columns, rows = _place(x.numbers, across), _place(y.numbers, upwards)
    return [Series("ω_n h = 1", columns[inside], rows[inside], "dashed")] if inside.any() else []


def theory_text(axes: list[Axis]) -> list[ReportBlock]:
    """Return the meaning of the line of a map, if it has one."""
    if len(axes) < 2 or not _sampling(axes[0], axes[1]):
        return []
    return [
        Text(
            "The dashed line is where theory ends the stability of a critically damped loop whose torque is held over "
            "the sample time $h$: on a plant integrated exactly"
        ),
        Formula("omega_n h < 1"),
        Text(
            "and on PyBullet with $n$ steps in a sample time $4 - 4 w - w^2 / n > 0$ for $w = omega_n h$, that is "
            "$w < 0.83$ for one step and $w < 0.976$ for ten."
        ),
    ]


def _sampling(x: Axis, y: Axis) -> bool:
    """Return True if two axes are natural frequency and sample time, of the arm or of the same stage."""
    for first, second in ((x, y), (y, x)):
        if first.name.startswith(_FREQUENCY) and second.name.startswith(_PERIOD):
            positive = all(axis.numbers is not None and bool(axis.numbers.min() > 0) for axis in (x, y))
            return positive and first.name.removeprefix(_FREQUENCY) == second.name.removeprefix(_PERIOD)
    return False


def _place(values: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return at which column or row values lie, between two of them by their logarithms."""
    places: FloatArray = np.interp(np.log(wanted), np.log(values), np.arange(len(values), dtype=float))
    return places
