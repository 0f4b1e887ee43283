"""Growth of a deviation at a sample time."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.figures import columns
from runner.store import Run
from runner.study.measured import Measured


def growth(runs: Mapping[str, Run], name: str, words: str) -> Measured:
    """Return the tip error at the end of a run, which may have diverged, over that at its start."""
    error = np.linalg.norm(columns(runs[name].trace, "error"), axis=1)
    return Measured(words, float(error[-1] / error[0]))
