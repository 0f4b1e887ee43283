"""Preview of a sweep: its cells, the stored ones and the expected time, without a run."""

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.sweeps.check import Checked, check
from runner.sweeps.deadline import TimeLimitError, deadline
from runner.sweeps.estimate import Estimate, estimate
from runner.sweeps.plan import Plan
from runner.sweeps.run import Engine, duration_text, find_stored, make_rules

_WITHIN = 2.0  # s, for the estimate


@dataclass(frozen=True)
class Preview:
    """What a sweep would do.

    Attributes:
        checked: Result of the check of the cells.
        stored: True for each cell whose run is stored, shape (cells,).
        expected: Estimated CPU time of the missing runs; None if the estimate takes too long.
        duration: The expected duration in words; "" if nothing is missing.
    """

    checked: Checked
    stored: NDArray[np.bool_]
    expected: Estimate | None
    duration: str


def preview(plan: Plan, engine: Engine) -> Preview:
    """Check all cells of a plan and return the actions of its sweep; nothing is simulated or stored.

    Raises:
        ConfigError: if a cell cannot be run.
    """
    checked = check(plan)
    rules = make_rules(checked.first.sweep, checked.outputs / "sweeps" / "preview", len(plan.whole), "")
    ends = find_stored(checked, rules)
    stored = np.ones(len(plan), dtype=bool)
    stored[ends.left] = False
    missing = {checked.names[cell] for cell in ends.left.tolist()}
    stored &= np.array([name not in missing for name in checked.names], dtype=bool)
    if not len(ends.left):
        return Preview(checked, stored, Estimate(0.0), "")
    until = time.monotonic() + _WITHIN  # before the deadline, whose error is then never taken for that of a probe
    try:
        with deadline(_WITHIN):
            expected = estimate(plan, checked, ends.left, rules.kept, until)
    except TimeLimitError:
        return Preview(checked, stored, None, f"an unknown time, because an estimate takes over {_WITHIN:g} s")
    return Preview(checked, stored, expected, duration_text(rules, len(ends.left), engine, expected))
