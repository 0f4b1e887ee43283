"""Effects of the axes of a sweep: shares of the variation by hand."""

import numpy as np
import pytest

from runner.statistics import axis_effects
from runner.statistics.effects import recode_levels


def test_the_share_is_the_sum_of_squares_between_levels_over_the_whole():
    levels = np.repeat([0, 1], 6)
    y = np.random.default_rng(2).normal(size=12) + levels
    means = np.array([y[level == levels].mean() for level in (0, 1)])[levels]
    wanted = np.sum((means - y.mean()) ** 2) / np.sum((y - y.mean()) ** 2)
    assert axis_effects({"a": levels}, y).effects[0].share == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize(("between", "share"), [(1.0, 1.0), (0.0, 0.0)])
def test_the_share_between_blocks(between, share):
    blocks, levels = np.repeat(np.arange(6), 2), np.tile([0, 1], 6)
    values = between * blocks + (1.0 - between) * np.tile([-1.0, 1.0], 6)
    assert axis_effects({"a": levels}, values, blocks).shared == pytest.approx(share)


def test_levels_that_another_axis_has_too_cannot_be_told_apart():
    levels = np.repeat([0, 1], 6)
    effects = axis_effects({"a": levels, "b": 1 - levels}, np.random.default_rng(6).normal(size=12)).effects
    assert [effect.remark for effect in effects[:2]] == ["cannot be told apart from the other axes"] * 2


def test_levels_are_recoded_without_gaps():
    np.testing.assert_array_equal(recode_levels(np.array([7, 3, 7, 9])), [1, 0, 1, 2])


def grid(*sizes, repetitions):
    """Levels of a full grid at every value, named a, b, ..."""
    cells = np.indices((*sizes, repetitions)).reshape(len(sizes) + 1, -1)
    return dict(zip("abc", cells[:-1], strict=False))


def effects_of(axes, values, seed=0):
    return {effect.axes: effect for effect in axis_effects(axes, values, seed=seed).effects}


def test_without_shared_seeds_nothing_is_blocked():
    axes = grid(3, repetitions=10)
    values = axes["a"] + np.random.default_rng(11).normal(size=30)
    own = axis_effects(axes, values, np.arange(30))
    assert own == axis_effects(axes, values)
    assert own.shared is None


def test_what_seeds_share_is_told_as_a_share():
    axes, block = grid(2, repetitions=8), np.tile(np.arange(8), 2)
    values = axes["a"] + 2.0 * block  # sums of squares 4 and 4 * 84, by hand
    assert axis_effects(axes, values, block).shared == pytest.approx(336.0 / 340.0)


def test_a_large_sweep_is_drawn_from_in_whole_blocks():
    level, block = np.indices((2, 5000)).reshape(2, -1)
    rng = np.random.default_rng(13)
    values = 0.05 * level + rng.normal(size=5000)[block] + 0.05 * rng.normal(size=10_000)
    analysis = axis_effects({"a": level}, values, block)
    assert analysis.n == 5000


def test_shares_by_hand():
    # y = 3 a + b on a grid of 2 x 2: sums of squares 9 and 1, no interaction.
    axes = grid(2, 2, repetitions=1)
    found = effects_of(axes, 3.0 * axes["a"] + axes["b"] - 5.0)
    assert found[("a",)].share == pytest.approx(0.9)
    assert found[("b",)].share == pytest.approx(0.1)
    assert found[("a", "b")].share == pytest.approx(0.0, abs=1e-12)


def test_shares_of_a_balanced_grid_and_its_noise_add_up():
    axes = grid(3, 4, repetitions=5)
    rng = np.random.default_rng(0)
    values = axes["a"] - 2.0 * axes["b"] + axes["a"] * axes["b"] + rng.normal(size=60)
    found = effects_of(axes, values)
    cell = axes["a"] * 4 + axes["b"]
    within = sum(np.sum((values[cell == c] - values[cell == c].mean()) ** 2) for c in range(12))
    total = np.sum((values - values.mean()) ** 2)
    assert sum(effect.share for effect in found.values()) == pytest.approx(1.0 - within / total)


def test_an_interaction_without_main_effects_is_found():
    axes = grid(2, 2, repetitions=10)
    values = np.where(axes["a"] == axes["b"], 1.0, -1.0) + 0.3 * np.random.default_rng(4).normal(size=40)
    found = effects_of(axes, values)
    assert found[("a", "b")].share > 0.8


def test_over_decades_a_product_is_no_interaction():
    axes = grid(3, 3, repetitions=4)
    factors = 10.0 ** axes["a"] * 3.0 ** axes["b"]
    noise = np.exp(0.05 * np.random.default_rng(5).normal(size=36))
    analysis = axis_effects(axes, factors * noise)
    assert analysis.logarithmic
    assert analysis.effects[-1].axes == ("a", "b")
    assert analysis.effects[-1].share < 1e-2


def test_missing_values_are_left_out_and_counted():
    axes = grid(3, 3, repetitions=4)
    values = 1.0 + axes["a"] + 0.01 * np.random.default_rng(6).normal(size=36)
    values[[0, 5]] = np.inf, np.nan
    analysis = axis_effects(axes, values)
    assert (analysis.n, analysis.left_out) == (34, 2)
    found = {effect.axes: effect for effect in analysis.effects}
    assert found[("a",)].share > 0.95


@pytest.mark.parametrize(
    ("axes", "values", "remark"),
    [
        (grid(3, repetitions=4), [2.0] * 12, "all values are the same"),
        (grid(3, repetitions=1), [np.inf, np.nan, 1.0], "fewer than two values"),
        (grid(3, repetitions=1), [np.inf] * 3, "fewer than two values"),
        (grid(1, repetitions=8), list(range(8)), "cannot be told apart from the other axes"),
    ],
)
def test_where_a_sample_is_too_small_it_is_said(axes, values, remark):
    (effect,) = axis_effects(axes, np.array(values, dtype=float)).effects
    assert effect.remark == remark


def test_a_large_sweep_is_drawn_from():
    axes = grid(5, 5, repetitions=1000)
    analysis = axis_effects({"a": axes["a"]}, axes["a"] + np.random.default_rng(8).normal(size=25_000))
    assert (analysis.n, analysis.left_out) == (5000, 0)
    assert analysis.effects[0].share == pytest.approx(2.0 / 3.0, abs=0.02)


def test_the_same_values_give_the_same_answer():
    axes = grid(3, 2, repetitions=3)
    values = np.random.default_rng(9).normal(size=18)
    assert axis_effects(axes, values) == axis_effects(axes, values)


def test_an_interaction_of_many_values_is_found_in_groups_of_them():
    axes = grid(40, 30, repetitions=1)
    rng = np.random.default_rng(10)
    product = (axes["a"] - 19.5) * (axes["b"] - 14.5) / 100.0
    with_product, without = (effects_of(axes, y + rng.normal(size=1200)) for y in (product, 0.1 * axes["a"]))
    assert with_product[("a", "b")].share > 0.4
    assert without[("a", "b")].share < 0.1
