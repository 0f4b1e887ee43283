"""Figures and tables of two sweeps: differences with intervals, medians, and the metrics over all cells."""

import math
from collections.abc import Sequence

import numpy as np

from runner.base.quantities import label_with_unit, quantity
from runner.reporting.answers import EXPLAINED, HEADER, Answer, Asked, ask, judge
from runner.reporting.comparison.pairs import Label, Pairs, label_text
from runner.reporting.comparison.sweeps import POOLED, SweepComparison, counts_by_sign
from runner.reporting.document import Block, Curves, Panel, Series, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import capital, title
from runner.reporting.sweep.subject import MOST_METRICS, spans_decades, whole_metrics

_MOST_CHARACTERS = 36  # of the names of all cells below a panel
_MOST_CELLS = 24
"""Cells that stand side by side; of more the medians are drawn against each other."""


def blocks(found: SweepComparison, wanted: Sequence[str]) -> list[Block]:
    """Return a figure of the first metrics that differ, or of the first ones."""
    known = choose_metrics(found, wanted)
    moved = [one for one in known if any(counts_by_sign(one))] or known
    pairs = found.pairs
    a, b = pairs.first, pairs.second
    many = len(pairs) > _MOST_CELLS
    panels = [(_against if many else _differences)(pairs, one.metric) for one in moved[:MOST_METRICS]]
    caption = (
        f"Median of each cell in {b} against that in {a}; on the line both are the same."
        if many
        else f"Difference {b} - {a} in each cell with its interval over the repetitions, if these are enough: each "
        "panel is a family of comparisons."
    )
    figure = Curves(literal(f"{caption} No point stands where it is beyond every number."), panels)
    return [figure] if many or not _numbered(pairs) else [figure, _cells(pairs)]


def _numbered(pairs: Pairs) -> bool:
    """Tell whether the names of cells are too long to stand below a figure, where numbers stand for them then."""
    return sum(len(_name(label)) for label in pairs.labels) > _MOST_CHARACTERS


def _name(label: Label) -> str:
    return ", ".join(label.values()) or "the only cell"


def _cells(pairs: Pairs) -> Table:
    rows = [literals([str(number), *label.values()]) for number, label in enumerate(pairs.labels, 1)]
    return Table("The cells of the figure.", ["cell", *literals(pairs.keys)], rows, (0,))


def _differences(pairs: Pairs, metric: str) -> Panel:
    labels = [label_text(label) for label in pairs.labels]
    answers = judge(ask(list(pairs.each()), [metric]), [metric])
    x = np.array([labels.index(label_text(answer.at)) for answer in answers], dtype=float)
    ends = np.array([_ends(answer) for answer in answers], dtype=float).reshape(-1, 3)
    low, median, high = np.where(np.isfinite(ends), ends, np.nan).T
    gap = np.full(len(x), np.nan)
    edge = np.array([-0.5, len(labels) - 0.5])
    hints = [f"{label_text(answer.at)}: {answer.word}" for answer in answers]
    series = [
        Series("", edge, np.zeros(2), "dotted", color=1),
        Series("", np.repeat(x, 3), np.column_stack([low, high, gap]).ravel(), color=0),
        Series("", x, median, "points", color=0, hints=hints),
    ]
    numbered = _numbered(pairs)
    names = [str(number) if numbered else _name(label) for number, label in enumerate(pairs.labels, 1)]
    across = "cell" if numbered or not pairs.keys else ", ".join(pairs.keys)
    label = label_with_unit(f"{pairs.second} - {pairs.first}", pairs.a.units[metric])
    return Panel(capital(title(metric)), across, label, series, x_names=names)


def _ends(answer: Answer) -> tuple[float, float, float]:
    low, high = answer.interval or (np.nan, np.nan)
    return (low, answer.comparison.difference, high)


def _against(pairs: Pairs, metric: str) -> Panel:
    x, y = pairs.a.medians(metric)[pairs.of_a], pairs.b.medians(metric)[pairs.of_b]
    known = np.isfinite(x) & np.isfinite(y)
    both = np.concatenate([x[known], y[known]])
    log = spans_decades(both)
    ends = np.array([both.min(), both.max()]) if both.size else np.array([0.0, 1.0])
    hints = [label_text(label) for label, shown_ in zip(pairs.labels, known.tolist(), strict=True) if shown_]
    series = [
        Series("", ends, ends, "dotted", color=1),
        Series("", x[known], y[known], "points", color=0, hints=hints),
    ]
    across, up = (label_with_unit(side.name, pairs.a.units[metric]) for side in (pairs.a, pairs.b))
    return Panel(capital(title(metric)), across, up, series, log, log)


def choose_metrics(found: SweepComparison, wanted: Sequence[str]) -> list[Answer]:
    """Return the answers in the metrics asked for, or in all but those of one direction or joint, errors first."""
    by_name = {one.metric: one for one in found.answers}
    return [by_name[name] for name in (wanted or whole_metrics(by_name)) if name in by_name]


def table_blocks(found: SweepComparison, wanted: Sequence[str]) -> list[Block]:
    """Return what is compared and how, the table over all cells, and that of those with the largest differences."""
    a, b = found.pairs.first, found.pairs.second
    whole = choose_metrics(found, wanted)
    parts = [one for one in found.answers if one not in whole]
    text = f"The difference is {b} - {a}. {EXPLAINED} {POOLED}"
    tables: list[Block] = [Text(text), _table("Every metric over all cells that both have.", found.pairs, whole)]
    if parts:
        tables.append(_table("Metrics of one direction or joint, likewise.", found.pairs, parts, folded=True))
    if found.cells:
        caption = (
            "Largest differences in one cell, in relation to the size of the metric: chosen from "
            f"{found.candidates}, at most three of a metric; not tested."
        )
        rows = [[literal(label_text(one.at)), *_row(one), _median(one.comparison.difference, one.unit)]
                for one in found.cells]  # fmt: skip
        tables.append(Table(caption, ["cell", "metric", a, b, "difference"], rows, (2, 3, 4)))
    return tables


def _table(caption: str, pairs: Pairs, some: Sequence[Answer], folded: bool = False) -> Table:
    many = len(pairs) > 1
    more = ["cells below, above 0"] if many else []
    header = ["metric", pairs.first, pairs.second, *HEADER, literal(f"{pairs.second} is"), *more]
    rows = [[*_row(one), *one.cells, *(["{}, {}".format(*counts_by_sign(one))] if many else [])] for one in some]
    return Table(caption, header, rows, tuple(range(1, 3 + len(HEADER))), folded=folded)


def _row(one: Asked) -> list[str]:
    return [literal(title(one.metric)), *(_median(median, one.unit) for median in one.comparison.medians)]


def _median(value: float, unit: str) -> str:
    return quantity(value, unit) if math.isfinite(value) else "beyond every number"
