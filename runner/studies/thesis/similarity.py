"""Comparison of the Mini with the ten times slower Macro at equal control steps."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.figures import joint_columns
from runner.store import Run


def most_apart(stem: str, times: float) -> Callable[[Run, Run], float]:
    """Return the largest difference of a signal of the Macro's joints and so many times the Mini's, at equal ticks."""

    def largest(macro: Run, mini: Run) -> float:
        rows = min(len(macro.trace), len(mini.trace))
        a, b = (joint_columns(run.trace[:rows], stem) for run in (macro, mini))
        return float(np.abs(a - times * b).max())

    return largest


def ten_times(column: str) -> Callable[[Run, Run], FloatArray]:
    """Return a signal of the Mini ten times as large, at the ticks of the Macro."""
    return lambda macro, mini: 10.0 * mini.trace[column].to_numpy()[: len(macro.trace)]
