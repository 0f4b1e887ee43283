"""Remedies of failures: the largest value that finishes, and the bound of the law."""

from dataclasses import replace

import numpy as np
from support.sample_sweep import measurements

from runner.reporting.sweep.stability import causes_of_failure, remedies
from runner.reporting.sweep.subject import choose

FREQUENCY = "controller.natural_frequency"
AXES = {FREQUENCY: [30.0, 100.0, 300.0, 1000.0], "controller": ["a", "b"]}


def swept(failed, axes=AXES, ratios=None):
    """Return a sweep with failed cells, and the ratio of the velocity gain to its bound in some cells."""
    sample = measurements(axes, {"rms": lambda *_: np.ones(6)})
    count = len(sample.hashes)
    caveats = [[{"rule": "unstable_gains", "text": "...", "value": ratios[cell]}] if cell in (ratios or {}) else []
               for cell in range(count)]  # fmt: skip
    statuses = ["failed" if cell in failed else "ok" for cell in range(count)]
    return choose(replace(sample, statuses=statuses, caveats=caveats))


def test_the_largest_stable_value_has_the_bound_of_the_law():
    (text,) = remedies(swept(range(2, 8), ratios={4: 3.0, 5: 3.0, 6: 10.0, 7: 10.0}))
    assert text == (
        f"{FREQUENCY}: stable up to 30, fails at 100 (the velocity loop is stable below 100, if no torque is at its "
        "limit)."
    )


def test_the_factor_is_a_range_over_the_failed_cells():
    """T9: 30 times too large is the worst cell, not "every run"."""
    found = causes_of_failure(swept(range(4, 8), ratios={4: 3.0, 5: 3.0, 6: 10.0, 7: 30.0}))
    assert found.endswith("is 3 to 30 times too large.")


def test_boundaries_that_differ_are_told_with_their_condition():
    (text,) = remedies(swept([2, 4, 5, 6, 7]))
    assert text == (
        f"{FREQUENCY}: stable up to 30, fails at 100 at controller=a; stable up to 100, fails at 300 at controller=b."
    )


def test_small_values_may_fail_and_islands_have_no_boundary():
    assert remedies(swept([0, 1])) == [f"{FREQUENCY}: fails at 30, stable from 100 on."]
    assert remedies(swept([2, 3])) == []
    assert remedies(swept(range(8))) == []
    assert remedies(swept([])) == []
