"""Rollouts: the corrected formula does ten times better than the printed one."""

import numpy as np
import pytest

from runner.audit.entry import entries
from runner.audit.rollout import run_rollout
from runner.audit.sources import sources

NAMES = sorted({(source, entry.rollout) for source in sources() for _, entry in entries(source) if entry.rollout})


@pytest.fixture(scope="module", params=NAMES)
def rollout(request):
    return run_rollout(*request.param)


@pytest.mark.costs(2)
def test_the_right_formula_does_much_better_than_the_wrong_one(rollout):
    _, run = rollout
    right = np.nanmax(run.curves["corrected"])
    for name, values in run.curves.items():
        assert values.shape == run.x.shape
        if name != "corrected":
            assert np.nanmax(values) > 10 * max(right, 1e-6), name


def test_titles_and_axes_say_what_is_seen(rollout):
    words, _ = rollout
    assert words.title
    assert "(" in words.y_label
    assert words.text.endswith(".")
    assert not set("{}") & set(words.text)
