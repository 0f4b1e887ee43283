"""Figures and tables of two sweeps: differences with intervals, medians, and the metrics over all cells."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from runner.base.quantities import label_with_unit, quantity
from runner.reporting.answers import EXPLAINED, HEADER, Answer, judge
from runner.reporting.comparison.cells import Matched, label_text
from runner.reporting.comparison.messages import POOLED
from runner.reporting.comparison.sweeps import MetricComparison, SweepComparison, by_cell
from runner.reporting.document import Block, Curves, Panel, Series, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import capital, title
from runner.reporting.sweep.subject import MOST_METRICS, first_screen, spans_decades, whole_metrics

_MOST_CHARACTERS = 36  # of the names of all cells below a panel
_MOST_CELLS = 24
"""Cells that stand side by side; of more the medians are drawn against each other."""


def blocks(found: SweepComparison, wanted: Sequence[str]) -> list[Block]:
    """Return a figure of the first metrics that differ, or of the first ones."""
    known = choose_metrics(found, wanted)
    moved = [one for one in known if one.below or one.above] or known
    chosen = [one.metric for one in moved[:MOST_METRICS]]
    a, b = found.a.name, found.b.name
    many = len(found.matched.labels) > _MOST_CELLS
    panels = [(_against if many else _differences)(found, metric) for metric in chosen]
    caption = (
        f"Median of each cell in {b} against that in {a}; on the line both are the same."
        if many
        else f"Difference {b} - {a} in each cell with its interval over the repetitions, if these are enough: each "
        "panel is a family of comparisons."
    )
    figure = Curves(literal(f"{caption} No point stands where it is beyond every number."), panels)
    return [figure] if many or not _numbered(found.matched) else [figure, _cells(found.matched)]


def _numbered(matched: Matched) -> bool:
    """Tell whether the names of cells are too long to stand below a figure, where numbers stand for them then."""
    return sum(len(_name(label)) for label in matched.labels) > _MOST_CHARACTERS


def _name(label: Mapping[str, str]) -> str:
    return ", ".join(label.values()) or "the only cell"


def _cells(matched: Matched) -> Table:
    rows = [literals([str(number), *label.values()]) for number, label in enumerate(matched.labels, 1)]
    return Table("The cells of the figure.", ["cell", *literals(matched.keys)], rows, (0,))


def _differences(found: SweepComparison, metric: str) -> Panel:
    matched = found.matched
    labels = [label_text(label) for label in matched.labels]
    compared = by_cell(found, metric)
    x = np.array([labels.index(label_text(one.cell)) for one in compared], dtype=float)
    answers = judge(compared, [metric])
    ends = np.array([_ends(answer) for answer in answers], dtype=float).reshape(-1, 3)
    low, median, high = np.where(np.isfinite(ends), ends, np.nan).T
    gap = np.full(len(x), np.nan)
    edge = np.array([-0.5, len(labels) - 0.5])
    hints = [f"{label_text(one.cell)}: {answer.word}" for one, answer in zip(compared, answers, strict=True)]
    series = [
        Series("", edge, np.zeros(2), "dotted", color=1),
        Series("", np.repeat(x, 3), np.column_stack([low, high, gap]).ravel(), color=0),
        Series("", x, median, "points", color=0, hints=hints),
    ]
    numbered = _numbered(matched)
    names = [str(number) if numbered else _name(label) for number, label in enumerate(matched.labels, 1)]
    across = "cell" if numbered or not matched.keys else ", ".join(matched.keys)
    unit = found.a.measurements.units[metric]
    label = label_with_unit(f"{found.b.name} - {found.a.name}", unit)
    return Panel(capital(title(metric)), across, label, series, x_names=names)


def _ends(answer: Answer) -> tuple[float, float, float]:
    low, high = answer.interval or (np.nan, np.nan)
    return (low, answer.comparison.difference, high)


def _against(found: SweepComparison, metric: str) -> Panel:
    medians = [side.measurements.medians(metric) for side in (found.a, found.b)]
    x, y = medians[0][found.matched.pairs.a], medians[1][found.matched.pairs.b]
    known = np.isfinite(x) & np.isfinite(y)
    both = np.concatenate([x[known], y[known]])
    log = spans_decades(both)
    ends = np.array([both.min(), both.max()]) if both.size else np.array([0.0, 1.0])
    unit = found.a.measurements.units[metric]
    hints = [label_text(label) for label, shown_ in zip(found.matched.labels, known.tolist(), strict=True) if shown_]
    series = [
        Series("", ends, ends, "dotted", color=1),
        Series("", x[known], y[known], "points", color=0, hints=hints),
    ]
    return Panel(
        capital(title(metric)),
        label_with_unit(found.a.name, unit),
        label_with_unit(found.b.name, unit),
        series,
        log,
        log,
    )


def choose_metrics(found: SweepComparison, wanted: Sequence[str]) -> list[MetricComparison]:
    """Return those asked for, or all but those of one direction or joint, errors first."""
    by_name = {one.metric: one for one in found.pooled}
    return [by_name[name] for name in (wanted or whole_metrics(by_name)) if name in by_name]


def answers(found: SweepComparison, wanted: Sequence[str]) -> dict[str, Answer]:
    """Return the answer over all cells in each metric, those of the first screen first."""
    first = first_screen([one.metric for one in choose_metrics(found, wanted)])
    judged = {answer.metric: answer for answer in judge(found.pooled, first)}
    return {name: judged[name] for name in dict.fromkeys([*first, *judged])}


def table_blocks(found: SweepComparison, wanted: Sequence[str]) -> list[Block]:
    """Return what is compared and how, the table over all cells, and that of those with the largest differences."""
    a, b = found.a.name, found.b.name
    whole = choose_metrics(found, wanted)
    parts = [one for one in found.pooled if one not in whole]
    text = f"The difference is {b} - {a}. {EXPLAINED} {POOLED}"
    judged = answers(found, wanted)
    tables: list[Block] = [Text(text), _table("Every metric over all cells that both have.", found, whole, judged)]
    if parts:
        tables.append(_table("Metrics of one direction or joint, likewise.", found, parts, judged, folded=True))
    if found.cells:
        caption = (
            "Largest differences in one cell, in relation to the size of the metric: chosen from "
            f"{found.candidates}, at most three of a metric; not tested."
        )
        rows = [[literal(label_text(one.cell)), *_row(one), _median(one.comparison.difference, one.unit)]
                for one in found.cells]  # fmt: skip
        tables.append(Table(caption, ["cell", "metric", a, b, "difference"], rows, (2, 3, 4)))
    return tables


def _table(
    caption: str,
    found: SweepComparison,
    some: Sequence[MetricComparison],
    judged: Mapping[str, Answer],
    folded: bool = False,
) -> Table:
    a, b = found.a.name, found.b.name
    many = len(found.matched.labels) > 1
    header = ["metric", a, b, *HEADER, literal(f"{b} is"), *(["cells below, above 0"] if many else [])]
    rows = [[*_row(one), *judged[one.metric].cells, *([f"{one.below}, {one.above}"] if many else [])] for one in some]
    return Table(caption, header, rows, tuple(range(1, 3 + len(HEADER))), folded=folded)


def _row(one: MetricComparison) -> list[str]:
    return [literal(title(one.metric)), *(_median(median, one.unit) for median in one.comparison.medians)]


def _median(value: float, unit: str) -> str:
    return quantity(value, unit) if math.isfinite(value) else "beyond every number"
