"""Interval of a median: its coverage, and its ends against order statistics and a bootstrap of SciPy and NumPy."""

import numpy as np
import pytest
from scipy import stats

from runner.statistics import SMALLEST_SAMPLE, median_interval, median_intervals


def interval_of(values, seed=0):
    return median_interval(np.array(values, dtype=float), seed)


@pytest.mark.parametrize(("n", "trials"), [(7, 300), (12, 300), pytest.param(40, 300, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("draw", "median"), [("standard_normal", 0.0), ("standard_exponential", np.log(2.0))])
def test_ninety_five_of_a_hundred_intervals_hold_the_median(n, trials, draw, median):
    rng = np.random.default_rng(n)
    intervals = [median_interval(getattr(rng, draw)(n)) for _ in range(trials)]
    covered = np.mean([interval.low <= median <= interval.high for interval in intervals])
    # 95 % less three standard errors of 300 trials; above, short samples may be on the safe side.
    assert covered > 0.95 - 3 * np.sqrt(0.95 * 0.05 / trials)
    assert covered < 1.0


def test_the_interval_shrinks_with_the_root_of_the_sample():
    rng = np.random.default_rng(1)
    widths = [np.mean([i.high - i.low for i in (median_interval(rng.normal(size=n)) for _ in range(20))])
              for n in (25, 225)]  # fmt: skip
    assert widths[0] / widths[1] == pytest.approx(3.0, rel=0.25)


def test_it_moves_and_scales_with_the_values():
    values = np.random.default_rng(2).normal(size=15)
    plain, moved = interval_of(values), interval_of(3.0 * values + 7.0)
    assert [moved.low, moved.median, moved.high] == pytest.approx(
        [3.0 * plain.low + 7.0, 3.0 * plain.median + 7.0, 3.0 * plain.high + 7.0]
    )


def test_its_ends_are_the_order_statistics_of_large_samples():
    # The exact interval of a median of 1000: order statistics 469 and 532 (binomial, 95 %).
    interval = interval_of(np.arange(1.0, 1001.0))
    assert interval.low == pytest.approx(469.0, abs=3.0)
    assert interval.high == pytest.approx(532.0, abs=3.0)


def test_percentiles_are_expanded_for_small_samples():
    # Of eight values 1.5 is the median of a resample or above it with probability 0.0058, which is the expanded tail;
    # only alpha / 2 of Student's t, 0.0090, would always be at 2.
    assert {interval_of(range(1, 9), seed).low for seed in range(20)} == {1.5, 2.0}


@pytest.mark.parametrize("n", [1, SMALLEST_SAMPLE - 1])
def test_small_samples_have_a_median_and_no_interval(n):
    interval = interval_of(range(n))
    assert (interval.median, interval.low, interval.high, interval.n) == ((n - 1) / 2, None, None, n)


def test_values_beyond_every_number_are_within_the_interval_and_not_averaged_away():
    interval = interval_of([1, 2, 3, 4, 5, 6, 7, np.inf, np.inf, np.inf])
    assert interval.median == 5.5
    assert interval.low < 5.5
    assert interval.high == np.inf
    assert not np.isnan(interval.low)


def test_equal_values_have_an_interval_of_no_width():
    interval = interval_of([2.0] * 8)
    assert (interval.low, interval.median, interval.high) == (2.0, 2.0, 2.0)


def test_the_same_values_give_the_same_interval():
    values = np.random.default_rng(3).normal(size=9)
    assert interval_of(values) == interval_of(values)


def test_the_order_of_the_values_makes_no_difference():
    values = np.random.default_rng(4).normal(size=9)
    assert interval_of(values) == interval_of(values[::-1])


def test_many_samples_have_the_intervals_of_each():
    samples = np.random.default_rng(5).normal(size=(30, 8))
    samples[3, :2] = np.inf
    low, high = median_intervals(samples)
    alone = [median_interval(sample) for sample in samples]
    assert low.tolist() == [interval.low for interval in alone]
    assert high.tolist() == [interval.high for interval in alone]


@pytest.mark.parametrize("n", [7, 12])
def test_the_resamples_are_those_of_a_bootstrap(n):
    values = np.random.default_rng(n).normal(size=n)
    resamples = np.sort(values)[np.random.default_rng(0).integers(0, n, (9999, n))]
    tail = stats.norm.cdf(np.sqrt(n / (n - 1)) * stats.t.ppf(0.025, n - 1))
    plain = np.quantile(np.median(resamples, axis=1), [tail, 1 - tail], method="inverted_cdf")
    assert [interval_of(values).low, interval_of(values).high] == pytest.approx(plain.tolist(), rel=1e-15)


@pytest.mark.parametrize("n", [2001, 1_000_000])
def test_of_many_values_too_its_ends_are_the_order_statistics(n):
    interval = interval_of(np.arange(1.0, n + 1.0))
    low, high = stats.binom.ppf([0.025, 0.975], n, 0.5)
    spread = 0.5 * np.sqrt(n)  # of the number of values below the median, with which 9999 resamples are uncertain
    assert interval.low == pytest.approx(low, abs=0.1 * spread)
    assert interval.high == pytest.approx(high + 1.0, abs=0.1 * spread)
