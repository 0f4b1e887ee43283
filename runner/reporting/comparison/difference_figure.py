"""Figure of paired differences: a dot for each pair, a bar for the interval, and a line at zero."""

from collections.abc import Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import label_with_unit
from runner.reporting.answers import Answer
from runner.reporting.document import Panel, Series
from runner.reporting.metric_titles import capital, title

_WIDTH = 0.3  # of a column, over which the dots are spread
_MOST_DOTS = 100  # in one column


def difference_panel(columns: Sequence[tuple[str, Answer]], across: str) -> Panel:
    """Return the differences of one metric, one column for each answer.

    Args:
        columns: The name below each column, and its answer; all are in the same metric.
        across: Label of the horizontal axis.
    """
    answers = [answer for _, answer in columns]
    ends = [(*(one.interval or (np.nan, np.nan)), one.comparison.difference) for one in answers]
    low, high, middle = np.where(np.isfinite(ends), ends, np.nan).T
    x = np.arange(len(answers), dtype=float)
    values = [_dots(answer) for answer in answers]
    shift = np.concatenate([_spread(len(some)) for some in values])
    hints = [f"{one.place}: {one.word}" for one in answers]
    series = [
        Series("", x[[0, -1]], np.zeros(2), "dotted", color=1, shift=np.array([-0.5, 0.5])),
        Series("a pair", np.repeat(x, [*map(len, values)]), np.concatenate(values), "points", color=2, shift=shift),
        Series("difference, interval", x, middle, "points", low, high, 0, hints),
    ]
    label = label_with_unit(f"difference in {title(answers[0].metric)}", answers[0].unit)
    return Panel(capital(title(answers[0].metric)), across, label, series, x_names=[name for name, _ in columns])


def _dots(answer: Answer) -> FloatArray:
    """Return the differences of the pairs that are drawn, shape (n,)."""
    values = answer.comparison.differences
    return values[np.isfinite(values)][:_MOST_DOTS]


def _spread(count: int) -> FloatArray:
    """Return places for some dots, spread evenly over a column in their order, relative to its middle, shape (n,)."""
    return _WIDTH * np.linspace(-1.0, 1.0, count) if count > 1 else np.zeros(count)
