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
    dots = np.concatenate([_dots(place, answer) for place, answer in enumerate(answers)], axis=1)
    series = [
        Series("", np.array([-0.5, len(answers) - 0.5]), np.zeros(2), "dotted", color=1),
        Series("a pair", dots[0], dots[1], "points", color=2),
        Series("interval", np.repeat(x, 3), np.column_stack([low, high, np.full(len(x), np.nan)]).ravel(), color=0),
        Series("difference", x, middle, "points", color=0, hints=[f"{one.place}: {one.word}" for one in answers]),
    ]
    label = label_with_unit(f"difference in {title(answers[0].metric)}", answers[0].unit)
    return Panel(capital(title(answers[0].metric)), across, label, series, x_names=[name for name, _ in columns])


def _dots(place: int, answer: Answer) -> FloatArray:
    """Return the dots of the pairs, spread evenly over the column in their order, shape (2, n)."""
    values = answer.comparison.differences
    values = values[np.isfinite(values)][:_MOST_DOTS]
    across = np.linspace(-1.0, 1.0, len(values)) if len(values) > 1 else np.zeros(len(values))
    return np.stack([place + _WIDTH * across, values])
