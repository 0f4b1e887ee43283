"""Signed-rank test: its exact distribution against all choices of signs, and against SciPy where that is exact."""

import itertools

import numpy as np
import pytest
from scipy import stats

from runner.statistics.signed_rank import EXACT_UP_TO, signed_rank


def counted_p_value(differences):
    """Share of all choices of signs with a smaller sum of ranks that is as small as the observed one."""
    ranks = stats.rankdata(np.abs(differences))
    signs = np.array(list(itertools.product([False, True], repeat=len(ranks))))
    positive = signs @ ranks
    smaller = np.minimum(positive, ranks.sum() - positive)
    observed = min(ranks[differences > 0].sum(), ranks[differences < 0].sum())
    return np.mean(smaller <= observed)


@pytest.mark.parametrize("n", range(1, 13))
def test_the_p_value_counts_all_choices_of_signs_with_ties_or_without(n):
    rng = np.random.default_rng(n)
    for decimals in (0, 1, 9):
        differences = rng.normal(0.5, 2.0, n).round(decimals)
        differences[differences == 0.0] = 1.0
        assert signed_rank(differences)[1] == counted_p_value(differences)


@pytest.mark.parametrize("n", [6, 20, 50])
def test_without_ties_it_is_the_exact_one_of_scipy(n):
    for seed in range(5):
        differences = np.random.default_rng([n, seed]).normal(0.3, 1.0, n)
        assert signed_rank(differences)[1] == pytest.approx(
            stats.wilcoxon(differences, method="exact").pvalue, rel=1e-14
        )


def test_ties_of_fourteen_differences_have_their_exact_p_value_and_not_that_of_the_normal_law():
    differences = np.concatenate([[1.0], np.full(8, 2.0), np.full(5, -2.0)])
    assert signed_rank(differences)[1] == counted_p_value(differences)
    assert signed_rank(differences)[1] == pytest.approx(0.424, abs=5e-4)
    assert stats.wilcoxon(differences, method="approx").pvalue == pytest.approx(0.386, abs=5e-4)


def test_equal_sizes_by_hand():
    """Ranks 2, 2, 2 and 4 with one -2: sums of 2 or less are 0 and three times 2, on both sides of 16 choices."""
    assert signed_rank(np.array([5.0, 5.0, -5.0, 9.0])) == ((8.0 - 2.0) / 10.0, 8.0 / 16.0)


def test_differences_of_zero_are_left_out():
    moved = np.array([3.0, -1.0, 2.0, 2.0, 7.0])
    assert signed_rank(np.insert(moved, [0, 2, 5], 0.0)) == signed_rank(moved)
    assert signed_rank(np.zeros(3)) == (0.0, 1.0)


def test_infinite_differences_are_the_largest_and_equal():
    finite = np.array([1.0, -2.0, 3.0, 9.0, -9.0, 9.0])
    assert signed_rank(np.where(np.abs(finite) == 9.0, np.copysign(np.inf, finite), finite)) == signed_rank(finite)


def test_all_of_one_sign_has_the_smallest_p_value_up_to_the_last_exact_number():
    for n in (1, 2, 40, EXACT_UP_TO):
        assert signed_rank(np.arange(1.0, n + 1.0)) == (1.0, min(1.0, 2.0 ** (1 - n)))
        assert signed_rank(np.full(n, -0.5)) == (-1.0, min(1.0, 2.0 ** (1 - n)))


def test_beyond_that_number_it_is_the_normal_law_of_scipy_and_near_the_exact_one():
    rng = np.random.default_rng(0)
    longest = rng.normal(0.1, 1.0, EXACT_UP_TO + 1).round(1)
    longest[longest == 0.0] = 0.05
    for sign in (1.0, -1.0):
        assert signed_rank(sign * longest)[1] == pytest.approx(
            stats.wilcoxon(longest, method="approx").pvalue, rel=1e-12
        )
    exact = longest[:EXACT_UP_TO]
    assert 0.05 < signed_rank(exact)[1] < 0.9
    assert signed_rank(exact)[1] != stats.wilcoxon(exact, method="approx").pvalue
    assert signed_rank(exact)[1] == pytest.approx(stats.wilcoxon(exact, method="approx").pvalue, rel=4e-3)
