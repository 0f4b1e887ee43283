"""Signed ranks: p against all choices of signs and SciPy, the interval against p, both with ties and zeros."""

import itertools

import numpy as np
import pytest
from scipy import stats

from runner.statistics.paired import EXACT_UP_TO, SignedRanks

LEVELS = (0.2, 0.05, 0.0125, 0.003)


def signs(n):
    return np.array(list(itertools.product([-1.0, 1.0], repeat=n)))


@pytest.mark.parametrize("n", range(1, 11))
def test_without_ties_p_counts_all_choices_of_signs(n):
    differences = np.random.default_rng(n).normal(0.5, 2.0, n)
    ranks = stats.rankdata(np.abs(differences))
    smaller = np.minimum((signs(n) > 0.0) @ ranks, (signs(n) < 0.0) @ ranks)
    observed = min(ranks[differences > 0].sum(), ranks[differences < 0].sum())
    assert SignedRanks(differences).p_value == np.mean(smaller <= observed)


@pytest.mark.parametrize("n", [6, 20, 50, EXACT_UP_TO])
def test_without_ties_it_is_the_exact_one_of_scipy(n):
    for seed in range(5):
        differences = np.random.default_rng([n, seed]).normal(0.3 / np.sqrt(n), 1.0, n)
        expected = stats.wilcoxon(differences, method="exact").pvalue
        assert SignedRanks(differences).p_value == pytest.approx(expected, rel=1e-12)


def test_beyond_that_number_it_is_the_normal_law_of_scipy():
    differences = np.random.default_rng(0).normal(0.1, 1.0, EXACT_UP_TO + 1)
    expected = stats.wilcoxon(differences, method="approx").pvalue
    assert SignedRanks(differences).p_value == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "sizes",
    [
        [1.0] * 8,
        [1, 1, 1, 2, 2, 3, 4, 4],
        [0, 0, 1, 1, 2, 3, 4, 5],
        [0] * 6 + [1, 2],
        [1, 2, 3, np.inf, np.inf, np.inf],
    ],
    ids=str,
)
def test_ties_zeros_and_infinities_keep_the_level(sizes):
    """If neither sign is preferred, p is below a level in at most that fraction of the choices of signs."""
    found = np.array([SignedRanks(each * np.array(sizes, dtype=float)).p_value for each in signs(len(sizes))])
    for level in (*LEVELS, *found):
        assert np.mean(found <= level) <= level


@pytest.mark.parametrize("n", [6, 8, 13, 40])
def test_the_interval_excludes_zero_exactly_if_p_is_below_its_level(n):
    shown = 0
    for seed in range(300):
        rng = np.random.default_rng([n, seed])
        differences = rng.standard_t(2, n) + rng.choice([0.0, 1.0])
        if seed % 3:
            differences = differences.round()  # ties and zeros
        if seed % 5 == 0:
            differences[0] = rng.choice([np.inf, -np.inf])
        ranks = SignedRanks(differences)
        for level in LEVELS:
            ends = ranks.interval(level)
            excludes = ends is not None and not ends[0] <= 0.0 <= ends[1]
            assert excludes == (ranks.p_value < level)
            shown += excludes
    assert shown > 50


def test_the_interval_misses_the_difference_as_often_as_its_level_says():
    level, n, count = 0.05, 12, 4000
    samples = np.random.default_rng(3).normal(1.0, 1.0, (count, n))
    ends = np.array([SignedRanks(sample).interval(level) for sample in samples])
    missed = np.mean((ends[:, 0] > 1.0) | (ends[:, 1] < 1.0))
    assert 0.03 < missed < level + 3.0 * np.sqrt(level * (1 - level) / count)


def test_estimate_and_effect_by_hand():
    """Walsh averages of -1, 2, 3, 4: -1, .5, 1, 1.5, 2, 2.5, 3, 3, 3.5, 4."""
    ranks = SignedRanks(np.array([-1.0, 2.0, 3.0, 4.0]))
    assert ranks.estimate == 2.25
    assert ranks.effect == pytest.approx(0.8)
    assert SignedRanks(np.array([1.0, np.inf, np.inf])).estimate == np.inf
    assert SignedRanks(np.array([np.inf, -np.inf])).estimate == 0.0


def test_all_of_one_sign_has_the_smallest_p_value_and_no_difference_has_the_largest():
    for n in (1, 2, 40, EXACT_UP_TO):
        assert SignedRanks(np.arange(1.0, n + 1.0)).p_value == min(1.0, 2.0 ** (1 - n))
        assert SignedRanks(np.full(n, -0.5)).p_value == min(1.0, 2.0 ** (1 - n))
    nothing = SignedRanks(np.zeros(8))
    assert (nothing.estimate, nothing.effect, nothing.p_value) == (0.0, 0.0, 1.0)
    assert nothing.interval(0.05) == (0.0, 0.0)


def test_with_too_few_pairs_for_a_level_there_is_no_interval():
    differences = np.arange(1.0, 9.0)
    assert SignedRanks(differences).interval(0.01) == (1.0, 8.0)  # p is 2 / 2^8, 0.0078
    assert SignedRanks(differences).interval(0.0078) is None
