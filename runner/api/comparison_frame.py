"""Comparisons as a table, with what may be said of each."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from runner.reporting.answers import Asked, judge

if TYPE_CHECKING:
    import pandas as pd


def comparison_frame(
    labels: Sequence[Mapping[str, str]], asked: Sequence[Asked], first: Sequence[str]
) -> "pd.DataFrame":
    """Return a row for each comparison of one question, with its corrected p, its interval and its word.

    Args:
        labels: Names of the things compared in each row: the columns first and second, behind the axes.
        asked: The comparisons, in the same order.
        first: Metrics of the first screen; see judge.
    """
    import pandas as pd

    missing = (np.nan, np.nan)
    rows = [
        {
            **label,
            "metric": answer.metric,
            "unit": answer.unit,
            "difference": answer.comparison.difference,
            "low": (answer.interval or missing)[0],
            "high": (answer.interval or missing)[1],
            "n": answer.comparison.n,
            "effect": answer.comparison.effect,
            "p": answer.p_value,
            "word": answer.word,
        }
        for label, answer in zip(labels, judge(asked, first), strict=True)
    ]
    return pd.DataFrame(rows).astype({"low": float, "high": float, "p": float})
