"""Paired comparison: effect, interval and p-value against samples whose difference is known."""

import numpy as np
import pytest

from runner.statistics import SMALLEST_SAMPLE, compare_paired


def pairs(n, shift, noise=0.1, seed=0):
    rng = np.random.default_rng(seed)
    a = rng.normal(scale=5.0, size=n)
    return a, a + shift + rng.normal(scale=noise, size=n)


def test_pairing_finds_a_difference_far_below_the_spread():
    comparison = compare_paired(*pairs(20, -0.3))
    assert comparison.verdict == "smaller"
    assert comparison.difference.low < -0.3 < comparison.difference.high
    assert comparison.effect < -0.9
    assert comparison.p_value < 1e-3


def test_exchange_of_the_two_turns_every_sign():
    a, b = pairs(20, 0.2)
    there, back = compare_paired(a, b), compare_paired(b, a)
    assert there.verdict == "larger"
    assert back.verdict == "smaller"
    assert back.difference.median == -there.difference.median
    assert back.effect == -there.effect
    assert back.p_value == there.p_value


@pytest.mark.parametrize(("sign", "effect"), [(1.0, 1.0), (-1.0, -1.0)])
def test_the_effect_is_one_when_all_pairs_agree(sign, effect):
    a = np.arange(10.0)
    assert compare_paired(a, a + sign * (1.0 + a)).effect == effect


def test_the_effect_by_hand():
    # Differences -1, 2, 3, 4: ranks 1 | 2 + 3 + 4 of 10.
    assert compare_paired(np.zeros(4), np.array([-1.0, 2.0, 3.0, 4.0])).effect == pytest.approx(0.8)


def test_without_a_difference_one_in_twenty_is_shown():
    verdicts = [compare_paired(*pairs(10, 0.0, seed=seed)).verdict for seed in range(300)]
    shown = np.mean([verdict != "no difference shown" for verdict in verdicts])
    assert 0.0 < shown < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 300)


def test_equal_samples_do_not_differ():
    a = np.arange(8.0)
    comparison = compare_paired(a, a)
    assert (comparison.effect, comparison.p_value) == (0.0, 1.0)
    assert comparison.verdict == "no difference shown"


def test_two_values_beyond_every_number_are_equal_and_one_is_the_largest_difference():
    a = np.array([1.0, 2.0, 3.0, np.inf, 5.0, 6.0, 7.0, np.inf])
    b = np.array([2.0, 3.0, 4.0, np.inf, 6.0, 7.0, 8.0, 1.0])
    comparison = compare_paired(a, b)
    assert comparison.difference.median == 1.0
    assert comparison.effect == pytest.approx((21 - 7) / 28)  # six ranks 1 to 6 against the rank 7


def test_few_pairs_are_said_to_be_few():
    comparison = compare_paired(np.zeros(5), np.ones(5))
    assert comparison.verdict == "too few pairs to say (5 of 6)"
    assert comparison.p_value is None
    assert comparison.difference.median == 1.0


@pytest.mark.parametrize("n", [SMALLEST_SAMPLE, SMALLEST_SAMPLE + 1])
def test_from_the_smallest_sample_on_there_is_a_p_value(n):
    comparison = compare_paired(np.zeros(n), np.arange(1.0, n + 1.0))
    assert comparison.verdict == "larger"
    assert comparison.p_value == 2.0 ** (1 - n)


def test_the_number_of_pairs_decides_not_that_of_those_which_differ():
    comparison = compare_paired(np.zeros(6), np.array([0.0, 0.0, 0.0, 0.0, 1.0, 2.0]))
    assert comparison.p_value == 0.5


@pytest.mark.parametrize(("a", "b"), [(np.zeros(3), np.zeros(4)), (np.zeros(0), np.zeros(0))])
def test_samples_that_are_no_pairs_are_refused(a, b):
    with pytest.raises(ValueError, match="pairs need two samples of one length"):
        compare_paired(a, b)
