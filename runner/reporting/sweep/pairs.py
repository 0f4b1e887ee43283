"""Comparisons in pairs: the values of one axis, within each combination of the values of the others."""

import math
from collections.abc import Sequence

import numpy as np

from runner.comparison.levels import SEED, LevelPair, level_pairs
from runner.comparison.pairs import compare, paired_values
from runner.comparison.words import at_once
from runner.drawing.thinning import spaced
from runner.quantities import with_ends
from runner.reporting.document import Block, Section, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import Subject
from runner.statistics import Comparison
from runner.sweeps.measurements import Axis

HEADER = ("difference", "95 % interval", "n", "effect", "p")
"""Columns of what `columns` returns."""

_SMALLEST = 1e-3  # p-value that is told
_MOST_ROWS = 24
_MOST_OF_OTHERS = 12  # rows of metrics behind the first


def section(subject: Subject) -> Section | None:
    """Return the comparisons of each metric, axis by axis; None where no two cells share their seeds."""
    # Choices, such as controllers, are what is compared most.
    axes = sorted(subject.axes, key=lambda axis: axis.numbers is not None)
    pairs = [(axis, level_pairs(subject.measurements, axis.name)) for axis in axes]
    made = 0
    sections: list[Section] = []
    for metric in subject.metrics:
        most = _MOST_OF_OTHERS if sections else _MOST_ROWS
        tables: list[Block] = []
        for axis, found in pairs:
            table = _table(subject, axis, metric, found, most)
            if table is not None:
                tables.append(table)
                made += len(table.rows)
        if tables:
            name = title(metric)
            sections.append(Section(f"{name[:1].upper()}{name[1:]}", tables))
    if not sections:
        return None
    text = (
        "The cells of a pair differ in one axis alone, and in what goes with it (Also differs). Both have the same "
        "seeds, and are compared repetition by repetition: median of the differences with its 95 % interval by the "
        "bootstrap over n pairs; effect size (rank-biserial correlation, 1 where the second is larger in every pair, "
        f"-1 where it is smaller); p of the signed-rank test. {at_once(made)} The option --metric compares by other "
        "metrics."
    )
    return Section("Compared in pairs", [Text(text)], sections)


def columns(comparison: Comparison, unit: str) -> list[str]:
    """Return the cells of a table that tell a comparison; their titles are HEADER."""
    difference = comparison.difference
    text, ends, shown = with_ends(difference.median, difference.low, difference.high, unit)
    return [
        text if math.isfinite(difference.median) else "beyond every number",
        "–" if difference.low is None else _with_unit(ends, shown),
        str(difference.n),
        f"{comparison.effect:.2f}",
        "–" if comparison.p_value is None else _chance(comparison.p_value),
    ]


def _chance(p_value: float) -> str:
    return f"{p_value:.2g}" if p_value >= _SMALLEST else f"< {_SMALLEST:g}"


def _with_unit(ends: str, unit: str) -> str:
    """Return a range with its unit behind the last number."""
    low, high = ends.split(" to ")
    if high != "never":
        return f"{ends} {unit}".strip()
    return ends if low == "never" else f"{low} {unit}".strip() + " to never"


def _table(subject: Subject, axis: Axis, metric: str, pairs: Sequence[LevelPair], most: int) -> Table | None:
    values = subject.measurements.values[metric]
    whole = not np.isnan(values).any()
    everything = [pair for pair in pairs if whole or paired_values(values, values, pair.cells)[0].size]
    chosen = [everything[place] for place in spaced(len(everything), most)]
    if not chosen:
        return None
    fewer = len(everything) > len(chosen)
    which = f" ({len(chosen)} of {len(everything)} pairs, spread evenly over the sweep)" if fewer else ""
    name = title(metric)
    within = "within each level of the other axes" if chosen[0].at else "as the only axis"
    if any(other.name == SEED for other in subject.axes):
        within += ", over all seeds"
    return Table(
        literal(f"{name[:1].upper()}{name[1:]} by {axis.name}, {within}{which}."),
        ["at", literal(axis.name), *HEADER, "the second is"],
        [_row(subject, metric, pair, found) for pair in chosen if (found := compare(values, values, pair.cells))],
        tuple(range(2, 2 + len(HEADER))),
    )


def _row(subject: Subject, metric: str, pair: LevelPair, comparison: Comparison) -> Sequence[str]:
    at = ", ".join(f"{name}={text}" for name, text in pair.at.items()) or "–"
    told = columns(comparison, subject.measurements.units[metric])
    return [*literals([at, f"{pair.first}, {pair.second}"]), *told, comparison.verdict]
