"""Comparisons in pairs: the values of one axis, within each combination of the values of the others."""

import math
from collections.abc import Sequence

import numpy as np

from runner.drawing.thinning import spaced
from runner.quantities import with_ends
from runner.reporting.document import Block, Section, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import Subject, value_name
from runner.statistics import Comparison, compare_paired
from runner.sweeps.measurements import Axis

HEADER = ("difference", "95 % interval", "n", "effect", "p")
"""Columns of what `columns` returns."""

_MOST_ROWS = 24

Pair = tuple[int, int]


def section(subject: Subject) -> Section | None:
    """Return the comparisons of the first metric, axis by axis; None where no two cells share their seeds."""
    # Choices, such as controllers, are what is compared most.
    axes = sorted(subject.axes, key=lambda axis: axis.numbers is not None)
    tables = [table for table in (_table(subject, axis) for axis in axes) if table is not None]
    if not tables:
        return None
    text = (
        "The cells of a pair differ in one axis alone, and in what goes with it (Also differs). Both have the same "
        "seeds, and are compared repetition by repetition: median of the differences with its 95 % interval by the "
        "bootstrap over n pairs; effect size (rank-biserial correlation, 1 where the second is larger in every pair, "
        "-1 where it is smaller); p of the signed-rank test. Where two cells do not differ p falls below 0.05 in at "
        "most one test in twenty: of many pairs some may by chance. The option --metric compares by another metric."
    )
    blocks: list[Block] = [Text(text), *tables]
    return Section("Compared in pairs", blocks)


def pairs(subject: Subject, axis: Axis) -> list[Pair]:
    """Return the cells to compare: along an axis each with the first that has the same levels of all other axes."""
    groups: dict[tuple[int, ...], list[int]] = {}
    others = [other for other in subject.axes if other is not axis]
    for cell in np.argsort(axis.level, kind="stable").tolist():
        groups.setdefault(tuple(int(other.level[cell]) for other in others), []).append(cell)
    found = [(first, cell) for _, (first, *rest) in sorted(groups.items()) for cell in rest]
    return [(a, b) for a, b in found if axis.level[a] != axis.level[b] and subject.share_seeds(a, b)]


def compare(subject: Subject, metric: str, a: int, b: int) -> Comparison | None:
    """Return how cell b differs from cell a in the repetitions that both have; None where there are none."""
    values = subject.measurements.values[metric]
    both = ~np.isnan(values[a]) & ~np.isnan(values[b])
    return compare_paired(values[a][both], values[b][both]) if both.any() else None


def columns(comparison: Comparison, unit: str) -> list[str]:
    """Return the cells of a table that tell a comparison; their titles are HEADER."""
    difference = comparison.difference
    text, ends, shown = with_ends(difference.median, difference.low, difference.high, unit)
    return [
        text if math.isfinite(difference.median) else "beyond every number",
        "–" if difference.low is None else _with_unit(ends, shown),
        str(difference.n),
        f"{comparison.effect:.2f}",
        "–" if comparison.p_value is None else f"{comparison.p_value:.2g}",
    ]


def _with_unit(ends: str, unit: str) -> str:
    """Return a range with its unit behind the last number."""
    low, high = ends.split(" to ")
    if high != "never":
        return f"{ends} {unit}".strip()
    return ends if low == "never" else f"{low} {unit}".strip() + " to never"


def _table(subject: Subject, axis: Axis) -> Table | None:
    metric = subject.metrics[0]
    values = subject.measurements.values[metric]
    everything = [(a, b) for a, b in pairs(subject, axis) if (~np.isnan(values[a]) & ~np.isnan(values[b])).any()]
    chosen = [everything[place] for place in spaced(len(everything), _MOST_ROWS)]
    rows = [row for row in (_row(subject, axis, metric, *pair) for pair in chosen) if row]
    if not rows:
        return None
    which = (
        f"{len(rows)} of {len(everything)} pairs, spread evenly over the sweep" if len(everything) > len(rows) else ""
    )
    name = title(metric)
    within = "within each level of the other axes" if len(subject.axes) > 1 else "as the only axis"
    return Table(
        literal(f"{name[:1].upper()}{name[1:]} by {axis.name}, {within}{f' ({which})' if which else ''}."),
        ["at", literal(axis.name), *HEADER, "the second is"],
        rows,
        tuple(range(2, 2 + len(HEADER))),
    )


def _row(subject: Subject, axis: Axis, metric: str, a: int, b: int) -> Sequence[str] | None:
    comparison = compare(subject, metric, a, b)
    if comparison is None:
        return None
    others = [f"{other.name}={value_name(other, int(other.level[a]))}" for other in subject.axes if other is not axis]
    first, second = (value_name(axis, int(axis.level[cell])) for cell in (a, b))
    names = [", ".join(others) or "–", f"{first}, {second}"]
    told = columns(comparison, subject.measurements.units[metric])
    return [*literals(names), *told, comparison.verdict]
