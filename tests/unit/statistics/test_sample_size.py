"""Pairs counted from the scatter of a pilot: the exact quantile, the mean power over pilots, and the range."""

import math

import numpy as np
import pytest
from scipy.special import nctdtrit, stdtrit

from runner.statistics import compare_paired
from runner.statistics.paired import fewest_pairs
from runner.statistics.sample_size import POWER, count_pairs, few_pairs, pairs_range, scale

PILOT = 8


@pytest.mark.parametrize("level", [0.05, 0.05 / 6, 0.05 / 100])
@pytest.mark.parametrize("freedom", [7, 9, 47, 1000])
def test_the_scale_is_the_quantile_of_the_noncentral_t_distribution(freedom, level):
    exact = nctdtrit(freedom, math.sqrt(2.0 * few_pairs(level)), POWER) * math.sqrt(math.pi / 3.0)
    assert scale(1.0, freedom, level) == pytest.approx(exact, rel=0.003)
    assert scale(2.5, freedom, level) == pytest.approx(2.5 * exact, rel=0.003)


@pytest.mark.parametrize("size", [0.4, 0.8])
@pytest.mark.parametrize("family", [1, 6])
def test_mean_power_over_pilots(size, family):
    """Of 400 pilots of eight, as many pairs as each counts show the difference in 75 to 85 % of cases."""
    level, shown = 0.05 / family, 0
    for seed in range(400):
        rng = np.random.default_rng((79, seed))
        count = compare_paired(np.zeros(PILOT), rng.standard_normal(PILOT)).pairs_needed(size, level)
        shown += compare_paired(np.zeros(count), size + rng.standard_normal(count)).p_value < level
    assert 0.75 < shown / 400 < 0.85


def test_the_estimate_must_also_exceed_the_least_difference():
    """Near the least difference that counts the number follows from the distance to it."""
    exceeded = (stdtrit(7, POWER) * math.sqrt(math.pi / 3.0) / 0.1) ** 2
    assert count_pairs(1.0, 7, 1.0, 0.05, 0.9) == pytest.approx(exceeded, rel=0.01)
    assert count_pairs(1.0, 7, 1.0, 0.05, 0.1) == count_pairs(1.0, 7, 1.0, 0.05) < exceeded
    assert count_pairs(1.0, 7, 1.0, 0.05, 1.0) == math.inf
    pilot = compare_paired(np.zeros(PILOT), np.arange(8.0))
    assert pilot.pairs_needed(1.0, 0.05, 1.0) is None


def test_the_range_contains_the_pairs_of_the_true_scatter_in_95_of_100_pilots():
    true = ((1.959964 + 0.841621) / 0.5) ** 2 * math.pi / 3.0 + few_pairs(0.05)
    ranges = [
        pairs_range(float(np.std(np.random.default_rng(seed).standard_normal(PILOT), ddof=1)), 7, 0.5, 0.05, 0.0, 0.95)
        for seed in range(2000)
    ]
    assert np.mean([low <= true <= high for low, high in ranges]) == pytest.approx(0.95, abs=0.02)


def test_pairs_and_range_are_never_fewer_than_a_test_needs():
    close = compare_paired(np.zeros(PILOT), 1e-6 * np.arange(8.0))
    assert close.pairs_needed(1.0, 0.01) == fewest_pairs(0.01)
    assert close.range_needed(1.0, 0.01) == (fewest_pairs(0.01), fewest_pairs(0.01))
    assert compare_paired(np.zeros(2), np.ones(2)).range_needed(1.0, 0.05) is None
