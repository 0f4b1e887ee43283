"""Effects of the axes of a sweep: shares by hand, p-values against F tests and the rate of false alarms."""

import numpy as np
import pytest
from scipy import stats

from runner.statistics import axis_effects
from runner.statistics.effects import Sample, recode_levels

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


def grid(*sizes, repetitions):
    """Levels of a full grid at every value, named a, b, ..."""
    cells = np.indices((*sizes, repetitions)).reshape(len(sizes) + 1, -1)
    return dict(zip("abc", cells[:-1], strict=False))


def effects_of(axes, values, seed=0):
    return {effect.axes: effect for effect in axis_effects(axes, values, seed=seed).effects}


def rates(*sizes, repetitions, effect=0.0, scatter=0.05, blocked=True, trials=1000):
    """Share of sweeps with p <= 0.05 for each effect: `effect` per level of a, a spread of 1 that seeds share."""
    cells = np.indices((*sizes, repetitions)).reshape(len(sizes) + 1, -1)
    axes, repetition = dict(zip("abc", cells[:-1], strict=False)), cells[-1]
    found = []
    for trial in range(trials):
        rng = np.random.default_rng([14, trial])
        shared = rng.normal(size=repetitions)[repetition]
        y = 10.0 + effect * axes["a"] + shared + np.asarray(scatter) * rng.normal(size=len(repetition))
        analysis = axis_effects(axes, y, repetition if blocked else None, seed=trial, permutations=199)
        found.append([tested.p_value <= 0.05 for tested in analysis.effects])
    return np.mean(found, axis=0)


@pytest.mark.parametrize("sizes", [{"sizes": (3,), "repetitions": 10}, {"sizes": (2, 3), "repetitions": 6}])
def test_one_test_in_twenty_is_below_five_per_cent_where_cells_share_their_seeds(sizes):
    found = rates(*sizes["sizes"], repetitions=sizes["repetitions"])
    assert ((found >= 0.03) & (found <= 0.07)).all()


def test_an_effect_smaller_than_what_seeds_share_is_found():
    # 0.15 per level, a shared spread of 1 and scatter of 0.05: lost where the shared spread counts as scatter.
    blocked, pooled = (rates(3, repetitions=10, effect=0.15, blocked=which, trials=100) for which in (True, False))
    assert blocked[0] > 0.9
    assert pooled[0] < 0.05


def test_unequal_scatter_makes_small_p_values_more_frequent():
    # The assumption of the test: here the levels differ only in their scatter, by a factor of 50.
    found = rates(3, repetitions=10, scatter=np.repeat([0.01, 0.05, 0.5], 10), trials=500)
    assert 0.07 < found[0] < 0.15


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


def test_blocks_against_the_f_test_of_a_randomised_block_design():
    rng = np.random.default_rng(15)
    level, block = np.indices((3, 20)).reshape(2, -1)
    y = (0.3 * level + 3.0 * rng.normal(size=20)[block] + rng.normal(size=60)).reshape(3, 20)
    rest = y - y.mean(axis=0) - y.mean(axis=1, keepdims=True) + y.mean()
    between = 20 * np.sum((y.mean(axis=1) - y.mean()) ** 2)
    exact = stats.f(2, 38).sf((between / 2) / (np.sum(rest**2) / 38))
    assert 0.02 < exact < 0.5
    (effect,) = axis_effects({"a": level}, y.ravel(), block).effects
    assert effect.p_value == pytest.approx(exact, abs=4 * np.sqrt(exact / 999))


def test_an_axis_that_changes_between_blocks_alone_is_tested_over_their_means():
    # Eight copies of each of twelve draws are twelve values, not ninety-six.
    seed, method, repetition = np.indices((2, 8, 6)).reshape(3, -1)
    block = seed * 6 + repetition
    found = []
    for trial in range(200):
        values = np.random.default_rng([15, trial]).normal(size=12)[block] + 0.01 * method
        effects = axis_effects({"seed": seed, "method": method}, values, block, permutations=99).effects
        found.append(effects[0].p_value <= 0.05)
    assert np.mean(found) < 0.1


def test_an_axis_that_changes_between_two_blocks_alone_has_a_share_and_no_p_value():
    # Means 2 and 6 of three values each: sums of squares 24 between them and 4 within.
    level = np.repeat([0, 1], 3)
    (effect,) = axis_effects({"a": level}, np.array([1.0, 2.0, 3.0, 5.0, 6.0, 7.0]), blocks=level).effects
    assert effect.share == pytest.approx(24.0 / 28.0)
    assert effect.p_value is None
    assert effect.remark == "no repetition to tell it from chance"


def test_a_large_sweep_is_drawn_from_in_whole_blocks():
    level, block = np.indices((2, 5000)).reshape(2, -1)
    rng = np.random.default_rng(13)
    values = 0.05 * level + rng.normal(size=5000)[block] + 0.05 * rng.normal(size=10_000)
    analysis = axis_effects({"a": level}, values, block, permutations=99)
    assert analysis.n == 5000
    assert analysis.effects[0].p_value == 0.01


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


def test_the_permutation_test_agrees_with_the_f_test_where_the_values_are_normal():
    rng = np.random.default_rng(1)
    axes = grid(3, repetitions=30)
    values = 0.25 * axes["a"] + rng.normal(size=90)
    exact = stats.f_oneway(*(values[axes["a"] == level] for level in range(3))).pvalue
    assert 0.02 < exact < 0.5
    assert effects_of(axes, values)[("a",)].p_value == pytest.approx(exact, abs=4 * np.sqrt(exact / 999))


def test_without_effects_p_values_are_uniform():
    axes = grid(3, 3, repetitions=2)
    rng = np.random.default_rng(2)
    found = [effects_of(axes, rng.standard_exponential(18), seed) for seed in range(60)]
    for name in (("a",), ("b",), ("a", "b")):
        p_values = [effects[name].p_value for effects in found]
        assert stats.kstest(p_values, "uniform").pvalue > 0.01


def test_what_matters_is_found_among_what_does_not():
    axes = grid(4, 3, repetitions=5)
    values = 1.5 * axes["a"] + np.random.default_rng(3).normal(size=60)
    found = effects_of(axes, values)
    assert found[("a",)].p_value <= 0.002
    assert found[("b",)].p_value > 0.05
    assert found[("a", "b")].p_value > 0.05


def test_the_observed_order_counts_among_the_permutations():
    # No permutation of 90 values in three clear groups comes near: one of 1 + 999 remains, the observed one.
    axes = grid(3, repetitions=30)
    clear = 10.0 * axes["a"] + np.random.default_rng(0).normal(size=90)
    assert effects_of(axes, clear)[("a",)].p_value == 1 / 1000


def test_permutations_that_do_as_much_count_as_large():
    # 0 and 1 dealt out evenly: no permutation does less than nothing, and the p-value is 1, never above.
    axes = grid(2, repetitions=8)
    even = np.tile([0.0, 1.0], 8)
    assert effects_of(axes, even)[("a",)].p_value == 1.0


def test_an_interaction_without_main_effects_is_found():
    axes = grid(2, 2, repetitions=10)
    values = np.where(axes["a"] == axes["b"], 1.0, -1.0) + 0.3 * np.random.default_rng(4).normal(size=40)
    found = effects_of(axes, values)
    assert found[("a", "b")].share > 0.8
    assert found[("a", "b")].p_value <= 0.002


def test_over_decades_a_product_is_no_interaction():
    axes = grid(3, 3, repetitions=4)
    factors = 10.0 ** axes["a"] * 3.0 ** axes["b"]
    noise = np.exp(0.05 * np.random.default_rng(5).normal(size=36))
    analysis = axis_effects(axes, factors * noise)
    assert analysis.logarithmic
    assert analysis.effects[-1].axes == ("a", "b")
    assert analysis.effects[-1].share < 1e-2
    assert analysis.effects[-1].p_value > 0.05


def test_missing_values_are_left_out_and_counted():
    axes = grid(3, 3, repetitions=4)
    values = 1.0 + axes["a"] + 0.01 * np.random.default_rng(6).normal(size=36)
    values[[0, 5]] = np.inf, np.nan
    analysis = axis_effects(axes, values)
    assert (analysis.n, analysis.left_out) == (34, 2)
    found = {effect.axes: effect for effect in analysis.effects}
    assert found[("a",)].share > 0.95
    assert found[("a",)].p_value <= 0.002


@pytest.mark.parametrize(
    ("axes", "values", "remark"),
    [
        (grid(3, repetitions=1), [1.0, 2.0, 4.0], "no repetition to tell it from chance"),
        (grid(2, repetitions=2), [1.0, 2.0, 4.0, 5.0], "too few values to tell it from chance"),
        (grid(3, repetitions=4), [2.0] * 12, "all values are the same"),
        (grid(3, repetitions=1), [np.inf, np.nan, 1.0], "fewer than two values"),
        (grid(3, repetitions=1), [np.inf] * 3, "fewer than two values"),
        (grid(1, repetitions=8), list(range(8)), "cannot be told apart from the other axes"),
    ],
)
def test_where_a_sample_is_too_small_it_is_said(axes, values, remark):
    (effect,) = axis_effects(axes, np.array(values, dtype=float)).effects
    assert effect.p_value is None
    assert effect.remark == remark


def test_one_value_a_cell_says_main_effects_and_no_interaction():
    axes = grid(4, 4, repetitions=1)
    found = effects_of(axes, axes["a"] + 0.1 * np.random.default_rng(7).normal(size=16))
    assert found[("a",)].p_value <= 0.01
    assert found[("a", "b")].remark == "no repetition to tell it from chance"


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
    assert with_product[("a", "b")].p_value <= 0.002
    assert with_product[("a", "b")].share > 0.4
    assert without[("a", "b")].p_value > 0.05
