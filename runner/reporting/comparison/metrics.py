"""Metric tables of two sweeps: all cells, and the cells with the largest differences."""

import math
from collections.abc import Mapping, Sequence

from runner.base.quantities import quantity
from runner.reporting.answers import EXPLAINED, HEADER, Answer, Asked, judge
from runner.reporting.comparison.cells import label_text
from runner.reporting.comparison.messages import POOLED
from runner.reporting.comparison.sweeps import MetricComparison, SweepComparison
from runner.reporting.document import Block, Table, Text
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import first_screen, whole_metrics


def choose_metrics(found: SweepComparison, wanted: Sequence[str]) -> list[MetricComparison]:
    """Return those asked for, or all but those of one direction or joint, errors first."""
    by_name = {one.metric: one for one in found.pooled}
    return [by_name[name] for name in (wanted or whole_metrics(by_name)) if name in by_name]


def answers(found: SweepComparison, wanted: Sequence[str]) -> dict[str, Answer]:
    """Return the answer over all cells in each metric, those of the first screen first."""
    first = first_screen([one.metric for one in choose_metrics(found, wanted)])
    asked = [Asked(one.metric, one.unit, one.comparison) for one in found.pooled]
    judged = {answer.metric: answer for answer in judge(asked, first)}
    return {name: judged[name] for name in dict.fromkeys([*first, *judged])}


def blocks(found: SweepComparison, wanted: Sequence[str]) -> list[Block]:
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
