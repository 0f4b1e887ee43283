"""Turning values: known roots, all changes of sign, failed runs, discrete values and coverage."""

import numpy as np
import pytest

from runner.statistics.paired import SignedRanks
from runner.statistics.turning import PAIRS, POINTS, find_turns

POINTS_ALONG = np.linspace(0.0, 1.0, POINTS).tolist()
OFFSETS = 0.05 * np.random.default_rng(0).standard_normal(PAIRS)
OFFSETS -= SignedRanks(OFFSETS).estimate


def asked(function):
    """Return the function of `find_turns` and the list of the values that it was asked for."""
    values = []

    def ask(some):
        values.extend(some)
        return [function(value) + OFFSETS for value in some]

    return ask, values


def test_a_smooth_root_is_found_with_its_span():
    ask, values = asked(lambda x: np.expm1(x - 0.37))
    (turn,) = find_turns(ask, POINTS_ALONG)
    assert turn.value == pytest.approx(0.37, abs=1e-3)
    low, high = SignedRanks(OFFSETS).interval(0.05)
    assert (turn.low, turn.high) == pytest.approx((0.37 + np.log1p(-high), 0.37 + np.log1p(-low)), abs=2e-3)
    assert len(values) == len(set(values)) < 20


def test_all_changes_of_sign_are_kept():
    ask, _ = asked(lambda x: np.cos(2.0 * np.pi * x))
    assert [turn.value for turn in find_turns(ask, POINTS_ALONG)] == pytest.approx([0.25, 0.75], abs=0.01)


def test_no_change_of_sign_is_no_turn():
    ask, values = asked(lambda x: 1.0 + x)
    assert find_turns(ask, POINTS_ALONG) == []
    assert values == POINTS_ALONG


def test_failed_runs_end_a_bracket():
    ask, _ = asked(lambda x: np.inf if x > 0.5 else -1.0)
    assert find_turns(ask, POINTS_ALONG) == []


def test_an_end_that_the_values_do_not_contain_is_open():
    ask, _ = asked(lambda x: x - 0.99)
    (turn,) = find_turns(ask, POINTS_ALONG)
    assert turn.low is not None
    assert turn.high is None


def test_discrete_values_end_at_neighbours():
    allowed = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    ask, values = asked(lambda x: x - 0.47)
    (turn,) = find_turns(ask, POINTS_ALONG, allowed)
    assert turn.between == (0.4, 0.6)
    assert set(values) <= set(allowed)


def test_a_search_without_time_ends():
    assert find_turns(lambda _: [], POINTS_ALONG) == []


@pytest.mark.costs(5)
def test_spans_contain_a_known_root():
    inside = 0
    for seed in range(50):
        rng = np.random.default_rng(seed)
        slopes, offsets = 1.0 + 0.2 * rng.standard_normal(PAIRS), 0.05 * rng.standard_normal(PAIRS)
        turns = find_turns(lambda some, s=slopes, o=offsets: [s * (x - 0.4) + o for x in some], POINTS_ALONG)
        inside += any((turn.low or 0.0) <= 0.4 <= (turn.high or 1.0) for turn in turns)
    assert inside >= 43  # of 47.5 expected; fewer with a probability of 1 %
