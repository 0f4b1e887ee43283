"""Tables of every metric of two sweeps, over all cells and in those that differ most."""

import math
from collections.abc import Sequence

from runner.comparison.cells import label_text
from runner.comparison.sweeps import MetricComparison, SweepComparison
from runner.comparison.words import POOLED, at_once
from runner.quantities import quantity
from runner.reporting.document import Block, Table, Text
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.sweep.pairs import HEADER, columns
from runner.reporting.sweep.subject import whole_metrics


def shown(found: SweepComparison, wanted: Sequence[str]) -> list[MetricComparison]:
    """Return those asked for, or all but those of one direction or joint, errors first."""
    by_name = {one.metric: one for one in found.pooled}
    return [by_name[name] for name in (wanted or whole_metrics(by_name)) if name in by_name]


def blocks(found: SweepComparison, wanted: Sequence[str]) -> list[Block]:
    """Return what is compared and how, the table over all cells, and that of those which differ most."""
    a, b = found.a.name, found.b.name
    whole = shown(found, wanted)
    parts = [one for one in found.pooled if one not in whole]
    text = (
        f"Both have the same seeds, and are compared repetition by repetition: median of the difference {b} - {a} and "
        f"its 95 % interval by the bootstrap over n pairs; effect (rank-biserial correlation, 1 where {b} is larger "
        f"in every pair, -1 where it is smaller); p of the signed-rank test. {POOLED} {at_once(found.comparisons)}"
    )
    tables: list[Block] = [Text(text), _table("Every metric over all cells that both have.", found, whole)]
    if parts:
        tables.append(_table("Metrics of one direction or joint, likewise.", found, parts, folded=True))
    if found.cells:
        caption = (
            "Cells that differ most, in relation to the size of the metric: "
            f"the first of {found.candidates}, at most three of a metric."
        )
        rows = [[literal(label_text(one.cell)), *_row(one)] for one in found.cells]
        header = ["cell", "metric", a, b, *HEADER, literal(f"{b} is")]
        tables.append(Table(caption, header, rows, tuple(range(2, 4 + len(HEADER)))))
    return tables


def _table(caption: str, found: SweepComparison, some: Sequence[MetricComparison], folded: bool = False) -> Table:
    a, b = found.a.name, found.b.name
    many = len(found.matched.labels) > 1
    header = ["metric", a, b, *HEADER, literal(f"{b} is"), *(["cells smaller, larger"] if many else [])]
    rows = [[*_row(one), *([f"{one.smaller}, {one.larger}"] if many else [])] for one in some]
    return Table(caption, header, rows, tuple(range(1, 3 + len(HEADER))), folded=folded)


def _row(one: MetricComparison) -> list[str]:
    medians = (_median(one.a, one.unit), _median(one.b, one.unit))
    return [literal(title(one.metric)), *medians, *columns(one.comparison, one.unit), one.comparison.verdict]


def _median(value: float, unit: str) -> str:
    return quantity(value, unit) if math.isfinite(value) else "never"
