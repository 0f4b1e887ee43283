"""Effects of the axes: fractions of the variance, main effects, and medians with intervals."""

from dataclasses import replace

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.reporting.charts.scales import EQUAL, widen_range
from runner.reporting.document import Curves, Panel, ReportBlock, Section, Series, Table, Text
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import MOST_GROUPS, Subject, key_label, spans_decades
from runner.reporting.table import numbers
from runner.statistics import EffectAnalysis
from runner.store.axes import Axis

_MOST_LEVELS = 200  # of an axis that are drawn, spread evenly
_MOST_LINES = 6
_APART = 0.1  # of curves at one name, so that their bars are seen
_MOST_INTERVALS = 60
_MOST_OF_IT = 0.5  # share of the spread from which on the draws are named


def section(subject: Subject) -> Section:
    """Return the share of the variation that each axis explains, and each cell over one axis or two."""
    blocks: list[ReportBlock] = [_table(subject.effects), Text(_explained(subject.effects))]
    many = [axis.name for axis in subject.axes if len(axis.values) > MOST_GROUPS]
    if many:
        blocks.append(Text(literal(f"{', '.join(many)}: taken in {MOST_GROUPS} groups of neighbouring values.")))
    if len(subject.axes) <= 2:
        blocks += [
            figure for figure in (cells_with_intervals(subject, metric) for metric in subject.metrics[:2]) if figure
        ]
    return Section("Effects of the axes", blocks)


def describe_shared_variation(subject: Subject) -> list[str]:
    """Return a sentence with the fraction of the spread of the first metric from the draws, if it exceeds half."""
    metric = subject.metrics[0]
    found = subject.effects[metric].shared
    if found is None or found < _MOST_OF_IT:
        return []
    return [f"The draws of the repetitions explain {_percent(found)} of the spread of the {title(metric)}."]


def _table(analyses: dict[str, EffectAnalysis]) -> Table:
    rows = [
        [" × ".join(effects[0].axes), *(effect.remark or _percent(effect.share) for effect in effects)]
        for effects in zip(*(analysis.effects for analysis in analyses.values()), strict=True)
    ]
    return Table(
        "Share of the variation that each axis explains, and what two axes do together beyond what each does by "
        "itself.",
        ["effect", *numbers(*map(title, analyses))],
        rows,
    )


def _explained(analyses: dict[str, EffectAnalysis]) -> str:
    logs = [title(name) for name, analysis in analyses.items() if analysis.logarithmic]
    lost = [f"{analysis.left_out} of {title(name)}" for name, analysis in analyses.items() if analysis.left_out]
    used = ", ".join(dict.fromkeys(str(analysis.n) for analysis in analyses.values()))
    shared = [
        f"{_percent(analysis.shared)} of the variation of {title(name)}"
        for name, analysis in analyses.items()
        if analysis.shared is not None
    ]
    texts = [
        f"A share is the sum of squares of an effect over the total; it is not tested. Values used: n = {used}.",
        f"Of {', '.join(logs)} the logarithms were taken, as the values span decades." if logs else "",
        f"Left out, as beyond every number: {', '.join(lost)}; shares of what is left may overlap." if lost else "",
        f"Cells of one seed share the random draws of a repetition, which make {', '.join(shared)}." if shared else "",
    ]
    return literal(" ".join(text for text in texts if text))


def _percent(share: float) -> str:
    return f"{number(100 * share, 2)} %" if share >= 1e-3 else "< 0.1 %"


def cells_with_intervals(subject: Subject, metric: str) -> Curves | None:
    """Return the median of each cell over one axis, a curve for each value of the other axis if there are two.

    Returns:
        The figure; None without points at two values, or with more curves or cells than a reader can distinguish.
    """
    # Along the axis with more values, and rather along numbers than along names.
    along, *other = sorted(subject.axes, key=lambda axis: (axis.numbers is None, -len(axis.values)))
    groups = other[0].level if other else np.zeros(len(subject.measurements.hashes), dtype=np.intp)
    count = len(other[0].values) if other else 1
    if count > _MOST_LINES or count * len(along.values) > _MOST_INTERVALS:
        return None
    low, high = subject.ends(metric)
    values, curves = (low, subject.medians[metric], high), []
    for group in range(count):
        cells = np.flatnonzero(groups == group)
        cells = cells[np.argsort(along.level[cells], kind="stable")].tolist()
        low, median, high = (np.where(np.isfinite(each), each, np.nan)[cells] for each in values)
        name = f"{other[0].name} = {other[0].text(group)}" if other else ""
        x = places(along)[along.level[cells]]
        hints, runs = subject.hints(cells), subject.hashes(cells)
        look = subject.looks(other[0])[group] if other else 0
        curve = Series(name, x, median, "points_line", low, high, look, hints, runs, level=bool(other))
        if along.numbers is None:  # a line between names would mean nothing
            beside = _APART * (group - (count - 1) / 2)
            curve = replace(curve, style="points", shift=np.full(x.size, beside))
        curves.append(curve)
    shown = {float(x) for series in curves for x in series.x[np.isfinite(series.y)]}
    if len(shown) < min(2, len(along.values)):  # at one value there is nothing to see along the axis
        return None
    panel = axis_panel("", along, subject.label(metric), curves, np.concatenate([series.y for series in curves]))
    sizes = sorted({subject.measurements.of_cell(metric, cell).size for cell in range(len(groups))})
    n = f"n = {sizes[0]}" if len(sizes) == 1 else f"n = {sizes[0]} to {sizes[-1]}"
    interval = f"its 95 % interval by the bootstrap over the repetitions ({n}), if enough"
    lost = int(np.isinf(subject.medians[metric]).sum())
    missing = f" {lost} of {len(groups)} cells are missing: most of their repetitions failed or never got there."
    caption = f"Median of each cell; shaded, or a bar, {interval}.{missing if lost else ''}"
    return Curves(caption, [panel], columns=1)


def places(axis: Axis) -> FloatArray:
    """Return the places of the values of an axis: their numbers, or 0, 1, ... for strings."""
    return np.arange(len(axis.values), dtype=float) if axis.numbers is None else axis.numbers


def axis_panel(title: str, axis: Axis, y_label: str, series: list[Series], y: FloatArray) -> Panel:
    """Return a panel over one axis of the sweep, logarithmic where its values, or the ordinates, span decades."""
    names = axis.texts if axis.numbers is None else ()
    x_log = axis.numbers is not None and spans_decades(axis.numbers)
    edges = [edge for each in series for edge in (each.y, each.low, each.high) if edge is not None]
    drawn = np.concatenate([edge[np.isfinite(edge)] for edge in edges])
    least = EQUAL * float(np.abs(drawn).max(initial=0.0))
    close = drawn.size and np.ptp(drawn) < least  # such differences are not to fill the panel
    y_range = widen_range(float(drawn.min()), float(drawn.max()), least) if close else None
    return Panel(title, key_label(axis), y_label, series, x_log, spans_decades(y), y_range=y_range, x_names=names)
