"""Motion duration at which a printed tracking error is reached."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Series
from runner.store import Run
from runner.studies.thesis.figures import printed
from runner.study.measured import Measured
from runner.study.prose.patterns import found
from runner.study.run_values import values


def printed_range(claim: int, low: float, high: float) -> list[Series]:
    """Return the range that a claim prints as a band between two durations."""
    ends = [np.full(2, printed(claim, end, "").value) for end in (0, -1)]
    return [Series("printed range", np.array([low, high]), ends[1], "dotted", low=ends[0], high=ends[1])]


def duration_of(runs: Mapping[str, Run], pattern: str, error: Measured, words: str) -> Measured:
    """Return at which duration, between those of a pattern's runs, the largest axis error is that given."""
    tried = found(runs, pattern)
    errors = values((one.run for one in tried), "max_axis_error")
    times = [float(one.levels["t_f"]) for one in tried]
    return Measured(words, float(np.interp(-float(error.value or 0.0), -errors, times)), "s")
