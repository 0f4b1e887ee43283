"""Clopper and Pearson's interval against its closed forms, its definition, and its coverage, computed exactly."""

import math

import numpy as np
import pytest
from scipy.stats import binom
from support.share_coverage import coverage

from runner.statistics.proportion import count_share, needed_repetitions, share_ends

ALPHA = 0.05


@pytest.mark.parametrize("n", [1, 2, 7, 40, 1000, 10**6])
def test_none_and_all_have_closed_forms(n):
    none, every = count_share(0, n), count_share(n, n)
    end = -math.expm1(math.log(ALPHA / 2) / n)  # 1 - (alpha/2)^(1/n)
    assert (none.low, every.high) == (0.0, 1.0)
    assert none.high == pytest.approx(end, rel=1e-9)
    assert every.low == pytest.approx(1.0 - end, rel=1e-9)


@pytest.mark.parametrize(("kept", "n"), [(1, 2), (3, 10), (9, 10), (37, 40), (7, 10**6), (999_993, 10**6)])
def test_at_its_ends_so_many_happen_in_one_case_of_forty(kept, n):
    found = count_share(kept, n)
    assert binom.sf(kept - 1, n, found.low) == pytest.approx(ALPHA / 2, rel=1e-6)
    assert binom.cdf(kept, n, found.high) == pytest.approx(ALPHA / 2, rel=1e-6)


def test_the_others_have_the_mirrored_interval():
    found = count_share(3, 50)
    assert (found.rest.kept, found.rest.share) == (47, 0.94)
    assert found.rest.low == pytest.approx(1.0 - found.high, rel=1e-12)
    assert found.rest.high == pytest.approx(1.0 - found.low, rel=1e-12)


@pytest.mark.parametrize("n", [5, 30, 200, 1000])
def test_it_never_covers_less_than_it_says(n):
    assert min(coverage(n, p) for p in np.linspace(0.002, 0.998, 250)) >= 1.0 - ALPHA


@pytest.mark.parametrize(
    ("n", "p", "exact"),
    [
        (100, 0.5, 0.9648),
        (400, 0.1, 0.9548),
        (1000, 0.02, 0.9589),
        (1000, 0.3, 0.9546),
        (10_000, 0.01, 0.9558),
        (10**5, 1e-3, 0.9548),
        (10**5, 1e-4, 0.9754),
    ],
)
def test_where_both_ends_have_counts_beyond_them_it_covers_94_to_98_per_cent(n, p, exact):
    drawn = np.random.default_rng(0).binomial(n, p, 20_000)
    low, high = share_ends(drawn, np.full(len(drawn), n))
    simulated = float(((low <= p) & (p <= high)).mean())
    assert 0.94 <= simulated <= 0.98
    assert simulated == pytest.approx(coverage(n, p), abs=4.0 * math.sqrt(0.05 * 0.95 / len(drawn)))
    assert coverage(n, p) == pytest.approx(exact, abs=1e-4)


def test_what_is_rare_it_covers_nearly_always():
    """If less than one failure is expected, the lower end is above the truth only if two happen."""
    assert coverage(1000, 1e-4) > 0.98
    assert coverage(100, 1e-3) > 0.98


def test_repetitions_needed_where_none_failed():
    wanted = needed_repetitions(count_share(0, 100), 1e-4)
    assert wanted == math.ceil(math.log(ALPHA / 2) / math.log1p(-1e-4)) == 36_887
    assert count_share(0, wanted).high < 1e-4 <= count_share(0, wanted - 1).high


@pytest.mark.parametrize(("kept", "n", "probability"), [(3, 100, 0.1), (3, 100, 0.01), (1, 100, 0.02), (5, 10, 0.4)])
def test_repetitions_needed_where_some_did(kept, n, probability):
    wanted = needed_repetitions(count_share(kept, n), probability)
    assert wanted >= n
    found = count_share(round(kept / n * wanted), wanted)
    assert found.high < probability or found.low > probability


def test_no_number_tells_a_share_from_itself():
    assert needed_repetitions(count_share(1, 100), 0.01) is None


def test_without_draws_the_interval_is_the_proportion_itself():
    every, none = count_share(30, 30, exact=True), count_share(0, 1, exact=True)
    assert (every.low, every.high, every.exact) == (1.0, 1.0, True)
    assert (every.rest.low, every.rest.high, every.rest.exact) == (0.0, 0.0, True)
    assert (none.low, none.high) == (0.0, 0.0)
    low, high = share_ends(np.array([0, 0]), np.array([30, 30]), np.array([True, False]))
    assert (high[0], high[1]) == (0.0, pytest.approx(1.0 - 0.025 ** (1 / 30)))
    assert low.tolist() == [0.0, 0.0]
