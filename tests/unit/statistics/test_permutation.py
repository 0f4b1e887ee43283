"""Permutation tests against closed forms: shares of a variation, exact p-values, and samples that say nothing."""

import numpy as np
import pytest

from runner.statistics.permutation import Sample, recode_levels

LEVELS = np.repeat([0, 1], 6)
ALONE = np.arange(12)


def _sample(y, blocks=ALONE, permutations=499):
    return Sample(np.asarray(y, dtype=float), blocks, np.random.default_rng(1), permutations)


def test_the_share_is_the_sum_of_squares_between_levels_over_the_whole():
    y = np.random.default_rng(2).normal(size=12) + LEVELS
    means = np.array([y[level == LEVELS].mean() for level in (0, 1)])[LEVELS]
    wanted = np.sum((means - y.mean()) ** 2) / np.sum((y - y.mean()) ** 2)
    assert _sample(y).test([], LEVELS).share == pytest.approx(wanted, rel=1e-12)


def test_levels_that_are_far_apart_have_the_smallest_p_value():
    y = np.random.default_rng(3).normal(size=12) + 100.0 * LEVELS
    tested = _sample(y).test([], LEVELS)
    # Of 12! / (6! 6!) arrangements two are as large.
    assert 1 / 500 <= tested.p_value <= 8 / 500


def test_p_values_without_an_effect_are_uniform():
    rng = np.random.default_rng(4)
    values = [Sample(rng.normal(size=12), ALONE, rng, 99).test([], LEVELS).p_value for _ in range(200)]
    assert min(values) >= 0.01
    assert 0.4 < np.mean(values) < 0.6


def test_offsets_of_blocks_are_no_part_of_the_scatter():
    blocks, levels = np.repeat(np.arange(6), 2), np.tile([0, 1], 6)
    noise = np.random.default_rng(5).normal(size=12)
    near, far = (_sample(noise + levels + size * blocks, blocks).test([], levels) for size in (0.0, 1000.0))
    assert far.p_value == near.p_value
    assert far.share < near.share


@pytest.mark.parametrize(("between", "share"), [(1.0, 1.0), (0.0, 0.0)])
def test_the_share_between_blocks(between, share):
    blocks = np.repeat(np.arange(6), 2)
    assert _sample(between * blocks + (1.0 - between) * np.tile([-1.0, 1.0], 6), blocks).shared() == pytest.approx(
        share
    )


@pytest.mark.parametrize(
    ("y", "remark"),
    [
        ([1.0], "fewer than two values"),
        ([2.0, 2.0, 2.0], "all values are the same"),
    ],
)
def test_samples_that_say_nothing(y, remark):
    tested = _sample(y, np.arange(len(y))).test([], np.zeros(len(y), dtype=int))
    assert (tested.share, tested.p_value, tested.remark) == (0.0, None, remark)


def test_levels_that_another_axis_has_too_cannot_be_told_apart():
    tested = _sample(np.random.default_rng(6).normal(size=12)).test([LEVELS], 1 - LEVELS)
    assert (tested.p_value, tested.remark) == (None, "cannot be told apart from the other axes")


def test_levels_are_recoded_without_gaps():
    np.testing.assert_array_equal(recode_levels(np.array([7, 3, 7, 9])), [1, 0, 1, 2])
