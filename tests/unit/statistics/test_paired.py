"""Paired comparison: estimate, effect and pairs that are needed against samples whose difference is known."""

import numpy as np
import pytest

from runner.statistics import SMALLEST_SAMPLE, compare_paired, fewest_pairs


def pairs(n, shift, noise=0.1, seed=0):
    rng = np.random.default_rng(seed)
    a = rng.normal(scale=5.0, size=n)
    return a, a + shift + rng.normal(scale=noise, size=n)


def test_pairing_finds_a_difference_far_below_the_spread():
    comparison = compare_paired(*pairs(20, -0.3))
    low, high = comparison.interval(0.05)
    assert low < -0.3 < high < 0.0
    assert comparison.effect < -0.9
    assert comparison.p_value < 1e-3


def test_exchange_of_the_two_turns_every_sign():
    a, b = pairs(20, 0.2)
    there, back = compare_paired(a, b), compare_paired(b, a)
    assert back.difference == -there.difference
    assert back.effect == -there.effect
    assert back.p_value == there.p_value
    assert back.interval(0.05) == tuple(-end for end in reversed(there.interval(0.05)))
    assert back.medians == there.medians[::-1]


@pytest.mark.parametrize(("sign", "effect"), [(1.0, 1.0), (-1.0, -1.0)])
def test_the_effect_is_one_when_all_pairs_agree(sign, effect):
    a = np.arange(10.0)
    assert compare_paired(a, a + sign * (1.0 + a)).effect == effect


def test_two_values_beyond_every_number_are_no_pair_and_one_is_the_largest_difference():
    a = np.array([1.0, 2.0, 3.0, np.inf, 5.0, 6.0, 7.0, np.inf])
    b = np.array([2.0, 3.0, 4.0, np.inf, 6.0, 7.0, 8.0, 1.0])
    comparison = compare_paired(a, b)
    assert comparison.differences.tolist() == [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -np.inf]
    assert comparison.lost == (1, 0)
    assert str(comparison.empty) == "neither has a value in 1 of 8 repetitions"
    assert comparison.difference == 1.0


def test_without_any_pair_there_is_no_number():
    never = np.full(8, np.inf)
    comparison = compare_paired(never, never)
    assert (comparison.n, comparison.medians, comparison.p_value) == (0, (np.inf, np.inf), None)
    assert np.isnan([comparison.difference, comparison.effect]).all()
    assert comparison.interval(0.05) is None


def test_few_pairs_have_no_p_value_and_no_interval():
    comparison = compare_paired(np.zeros(5), np.ones(5))
    assert (comparison.n, comparison.difference) == (5, 1.0)
    assert comparison.p_value is None
    assert comparison.interval(0.5) is None


@pytest.mark.parametrize("n", [SMALLEST_SAMPLE, SMALLEST_SAMPLE + 1])
def test_from_the_smallest_sample_on_there_is_a_p_value(n):
    assert compare_paired(np.zeros(n), np.arange(1.0, n + 1.0)).p_value == 2.0 ** (1 - n)


@pytest.mark.parametrize(
    ("level", "n"), [(0.05, 6), (2.0**-5, 7), (0.0312, 7), (0.0313, 6), (0.05 / 12, 9), (0.05 / 92, 12)]
)
def test_the_fewest_pairs_are_those_whose_smallest_p_is_below_the_level(level, n):
    assert fewest_pairs(level) == n
    assert 2.0 ** (1 - n) < level <= 2.0 ** (2 - n)


def test_the_pairs_that_are_needed_show_the_difference_in_four_of_five_samples():
    a, b = pairs(5000, 0.0, noise=1.0, seed=1)
    count = compare_paired(a, b).pairs_needed(0.5, 0.05)
    assert count == pytest.approx((1.960 + 0.842) ** 2 / 0.5**2 * np.pi / 3.0, rel=0.08)
    shown = [compare_paired(*pairs(count, 0.5, noise=1.0, seed=seed)).p_value < 0.05 for seed in range(400)]
    assert 0.74 < np.mean(shown) < 0.92


def test_the_closer_pairs_go_together_the_fewer_are_needed():
    loose, close = (compare_paired(*pairs(50, 0.0, noise)) for noise in (5.0, 0.5))
    assert loose.pairs_needed(1.0, 0.05) > 10 * close.pairs_needed(1.0, 0.05)
    assert compare_paired(np.arange(8.0), np.arange(8.0)).pairs_needed(1.0, 0.05) == 6


def test_the_smallest_difference_shown_needs_as_many_pairs_as_there_are():
    comparison = compare_paired(*pairs(60, 0.0, noise=1.0))
    least = comparison.smallest_shown(0.05)
    assert comparison.pairs_needed(least * (1.0 + 1e-9), 0.05) == 60
    assert least == pytest.approx((1.960 + 0.842) * np.sqrt(np.pi / 3.0 / 60), rel=0.3)
    assert compare_paired(*pairs(5, 0.0)).smallest_shown(0.05) is None


@pytest.mark.parametrize("difference", [0.0, np.nan])
def test_of_no_difference_no_number_of_pairs_is_told(difference):
    assert compare_paired(*pairs(8, 0.0)).pairs_needed(difference, 0.05) is None


@pytest.mark.parametrize(("a", "b"), [(np.zeros(3), np.zeros(4)), (np.zeros(0), np.zeros(0))])
def test_samples_that_are_no_pairs_are_refused(a, b):
    with pytest.raises(ValueError, match="pairs need two samples of one length"):
        compare_paired(a, b)
