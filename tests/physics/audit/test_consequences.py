"""Simulated consequences: the corrected formula does ten times better than the printed one."""

import numpy as np
import pytest

from runner.papers.audit.consequence import simulate_consequence
from runner.papers.audit.entry import entries
from runner.papers.audit.sources import sources

NAMES = sorted(
    {(source, entry.consequence) for source in sources() for _, entry in entries(source) if entry.consequence}
)


@pytest.fixture(scope="module", params=NAMES)
def consequence(request):
    return simulate_consequence(*request.param)


@pytest.mark.costs(2)
def test_the_right_formula_does_much_better_than_the_wrong_one(consequence):
    _, run = consequence
    right = np.nanmax(run.curves["corrected"])
    for name, values in run.curves.items():
        assert values.shape == run.x.shape
        if name != "corrected":
            assert np.nanmax(values) > 10 * max(right, 1e-6), name


def test_titles_and_axes_say_what_is_seen(consequence):
    words, _ = consequence
    assert words.title
    assert "(" in words.y_label
    assert words.text.endswith(".")
    assert not set("{}") & set(words.text)
