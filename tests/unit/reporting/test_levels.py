"""Levels of an axis compared within one sweep, against shifts that are put in."""

from dataclasses import replace

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.reporting.comparison.difference_figure import difference_panel
from runner.reporting.comparison.pairs import MOST_PAIRS, compare, level_pairs
from runner.reporting.comparison.sweeps import answer_rows, compare_levels
from runner.statistics import compare_paired
from runner.store.axes import Axis
from runner.sweeps.measurements import Measurements


def grid(axes, value, seeds=(), repetitions=8):
    """Return a full grid of one metric, a function of the levels plus what the repetition draws."""
    shape = [len(values) for values in axes.values()]
    levels_ = np.stack(np.unravel_index(np.arange(int(np.prod(shape))), shape))
    found = np.array([value(*level) for level in levels_.T], dtype=float)
    noise = np.random.default_rng(1).normal(size=(len(found), repetitions))
    cells = len(found)
    return Measurements(
        axes=[Axis(name, values, levels_[place]) for place, (name, values) in enumerate(axes.items())],
        fixed=[],
        hashes=[str(cell) for cell in range(cells)],
        statuses=["ok"] * cells,
        failures=[""] * cells,
        units={"rms": "m"},
        values={"rms": found[:, None] + 1e-3 * noise},
        provenance={},
        seeds=np.array(seeds),
    )


LAWS = {"robot": ["macro", "xarm7"], "controller": ["a", "b", "c"]}


def test_all_levels_are_compared_with_each_other_pooled_and_within_each_condition():
    sweep = grid(LAWS, lambda robot, law: 10.0 + robot + law)
    found = compare_levels(sweep, "controller")
    assert [(one.at, *one.names) for one in found] == [
        (at, *laws)
        for at in ({}, {"robot": "macro"}, {"robot": "xarm7"})
        for laws in (("a", "b"), ("a", "c"), ("b", "c"))
    ]
    values = sweep.values["rms"]
    assert found[7].comparison.differences.tolist() == compare_paired(values[3], values[5]).differences.tolist()
    assert (found[7].metric, found[7].unit) == ("rms", "m")


def test_of_more_than_six_levels_each_is_compared_with_the_first():
    for count, pairs in ((6, 15), (7, 6)):
        sweep = grid({"controller.period": list(np.arange(float(count)))}, lambda period: period)
        assert len(level_pairs(sweep, "controller.period")) == pairs


def test_a_known_shift_is_found_and_none_is_none():
    shifted = grid(LAWS, lambda robot, law: 0.0)
    shifted.values["rms"][:] = shifted.values["rms"][0] + 0.25 * shifted.axes[1].level[:, None]
    for one in compare_levels(shifted, "controller"):
        expected = 0.5 if one.names == ("a", "c") else 0.25
        assert one.comparison.difference == pytest.approx(expected)
        assert one.comparison.effect == 1.0
    for one in compare_levels(shifted, "robot"):
        assert (one.comparison.difference, one.comparison.effect, one.comparison.p_value) == (0.0, 0.0, 1.0)


def test_axes_that_are_not_named_are_pooled_and_a_draw_counts_once():
    axes = {"robot": ["macro", "xarm7"], "noise": [1e-3, 1e-2, 1e-1], "controller": ["a", "b"]}
    sweep = grid(axes, lambda robot, noise, law: 100.0 * (1 + robot) + 7.0 * noise + 5.0 * law)
    one, other = compare_levels(sweep, "controller", within=["robot"])
    values = sweep.values["rms"]
    by_draw = compare_paired(values[0:6:2].mean(axis=0), values[1:6:2].mean(axis=0))
    assert one.comparison.differences == pytest.approx(by_draw.differences)
    assert one.comparison.a == pytest.approx(by_draw.a)
    assert (other.at, other.comparison.n) == ({"robot": "xarm7"}, 8)
    # The pooled axis changes both levels alike, so the shift is one for any noise.
    assert other.comparison.difference == pytest.approx(5.0, abs=5e-3)


def test_a_swept_seed_is_pooled_like_repetitions_and_can_be_asked_for():
    axes = {"seed": [0.0, 1.0, 2.0], "controller": ["a", "b"]}
    sweep = grid(axes, lambda seed, law: seed + law, seeds=[0, 0, 1, 1, 2, 2], repetitions=1)
    (pooled,) = compare_levels(sweep, "controller")
    assert (pooled.at, pooled.comparison.n) == ({}, 3)
    assert [one.at["seed"] for one in compare_levels(sweep, "controller", within=["seed"])] == ["0", "1", "2"]
    with pytest.raises(RunnerError, match="share their seed"):
        compare_levels(sweep, "seed")


def test_cells_of_different_seeds_are_no_pair():
    sweep = grid(LAWS, lambda robot, law: law)
    apart = replace(sweep, seeds=np.array([0, 1, 0, 0, 0, 0]))
    assert ["".join(one.names) for one in compare_levels(apart, "controller", within=["robot"])] == [
        "ac", "ab", "ac", "bc",
    ]  # fmt: skip


def test_cells_that_are_missing_are_left_out():
    sweep = grid({"robot": ["macro", "xarm7"], "controller": ["a", "b"]}, lambda robot, law: law)
    sweep.values["rms"][2] = np.nan
    assert [one.at for one in compare_levels(sweep, "controller")] == [{}, {"robot": "macro"}]
    listed = replace(sweep, axes=[replace(axis, level=axis.level[:3]) for axis in sweep.axes], hashes=sweep.hashes[:3])
    assert [pair.at for pair in level_pairs(listed, "controller")] == [{"robot": "macro"}]


def test_very_many_pairs_are_drawn_from_and_n_says_so():
    sweep = grid({"seed": np.arange(3000.0), "controller": ["a", "b"]}, lambda seed, law: law, repetitions=2)
    sweep = replace(sweep, seeds=np.repeat(np.arange(3000), 2))
    (found,) = compare_levels(sweep, "controller")
    assert found.comparison.n == MOST_PAIRS
    assert found.comparison.count == f"{MOST_PAIRS} of 6000 pairs"
    assert f", {MOST_PAIRS} of 6000 pairs, " in found.clause()
    assert found.comparison.difference == pytest.approx(1.0, abs=1e-3)
    assert (
        compare_levels(sweep, "controller")[0].comparison.differences.tolist() == found.comparison.differences.tolist()
    )


@pytest.mark.parametrize(
    ("axis", "within", "metrics", "message"),
    [
        (
            "controler",
            (),
            (),
            "unknown axis 'controler'. Allowed: robot, ",
        ),
        ("controller", ("robt",), (), "unknown axis 'robt'"),
        ("controller", ("controller",), (), "within: controller is the compared axis"),
        ("controller", (), ("rsm",), "unknown metric 'rsm'. Allowed: rms"),
    ],
)
def test_unknown_names_are_refused(axis, within, metrics, message):
    with pytest.raises(RunnerError) as caught:
        compare_levels(grid(LAWS, lambda robot, law: law), axis, within, metrics)
    assert message in str(caught.value)


def test_cells_of_one_draw_are_no_further_evidence():
    """Three levels that share every draw: eight pairs, not 24."""
    sweep = grid({"noise": [1.0, 2.0, 3.0], "controller": ["a", "b"]}, lambda noise, law: 0.0)
    drawn = np.random.default_rng(5).normal(size=8)
    sweep.values["rms"][:] = np.where(sweep.axes[1].level[:, None] == 1, drawn, 0.0)
    overall = compare_levels(sweep, "controller")[0].comparison
    assert overall.differences == pytest.approx(drawn)
    assert overall.p_value == compare_paired(np.zeros(8), drawn).p_value


def test_what_is_beyond_every_number_in_more_levels_on_one_side_is_so_in_the_mean():
    sweep = grid({"noise": [1.0, 2.0], "controller": ["a", "b"]}, lambda noise, law: law)
    values = sweep.values["rms"]
    values[1, 0] = values[2, 1] = values[0, 2] = values[1, 2] = np.inf  # b; a at the other level; both at one level
    overall = compare(level_pairs(sweep, "controller", ())[0], "rms")
    assert overall.differences[:2].tolist() == [np.inf, -np.inf]
    assert overall.differences[2] == pytest.approx(values[3, 2] - values[2, 2])  # only of the level with values
    assert overall.lost == (1, 1)
    assert str(overall.empty) == "neither has a value in 1 of 16 repetitions, at 1 of 2 levels"


def settling(levels=(1.0, 10.0, 400.0)):
    """Return a sweep in which both laws settle at one level only: at the others neither does, or both runs failed."""
    sweep = grid({"controller": ["a", "b"], "gain": list(levels)}, lambda law, gain: 1.0 + 0.1 * law)
    sweep.values["rms"][sweep.axes[1].level != 1] = np.inf
    return sweep


def test_a_level_without_any_value_counts_nothing_and_is_told():
    pooled, *each = compare_levels(settling(), "controller")
    assert (pooled.at, pooled.comparison.n, pooled.word) == ({}, 8, "larger")
    assert pooled.comparison.difference == pytest.approx(0.1, abs=5e-3)  # not a third of it
    assert "8 pairs, neither has a value in 16 of 24 repetitions, at 2 of 3 levels" in pooled.sentence()
    assert [one.word for one in each] == ["no value in either", "larger", "no value in either"]


def test_never_against_never_has_no_number_anywhere():
    lost = compare_levels(settling(), "controller")[1]
    assert lost.cells == ["–", "–", "0", "–", "–", "no value in either"]
    assert lost.short_cells == ["never", "–", "no value in either"]
    assert [str(cell) for cell in lost.plain_cells[2:]] == ["0", "-", "-", "no value in either"]
    assert lost.sentence() == "Rms: a and b have no value in any draw."
    row = answer_rows([lost])[0]
    assert np.isnan([row["difference"], row["effect"]]).all()
    assert (row["n"], row["p"], row["low"]) == (0, None, None)


def test_where_both_laws_fail_nothing_is_drawn_at_zero():
    answers = compare_levels(settling(), "controller")
    panel = difference_panel([(one.place, one) for one in answers], "gain")
    for place in (1, 3):  # the levels without a value
        for series in panel.series[1:]:
            drawn = np.abs(series.x - place) < 0.4
            assert not np.isfinite(series.y[drawn]).any()


def test_repetitions_that_are_copies_of_each_other_count_once():
    sweep = grid({"controller": ["a", "b"]}, lambda law: law)
    sweep.values["rms"][:] = [[1.0], [2.0]]
    assert compare_levels(sweep, "controller")[0].comparison.n == 1
    drawn = replace(sweep, values={**sweep.values, "peak": np.random.default_rng(1).normal(size=(2, 8))}, units={
        "rms": "m", "peak": "N m"})  # fmt: skip
    assert compare_levels(drawn, "controller", metrics=["rms"])[0].comparison.n == 8


def test_the_error_of_the_plant_is_that_of_the_difference():
    """Both sides are wrong by 0.3, and the second by 0.02 more in the first repetitions, which only are known."""

    def error(measurements):
        return compare(level_pairs(measurements, "controller")[0], "rms").error

    sweep = grid({"controller": ["a", "b"]}, lambda law: law)
    assert error(sweep) is None
    finer = sweep.values["rms"][:, :4] + [[0.3], [0.32]]
    known = replace(sweep, finer={"rms": finer})
    assert error(known) == pytest.approx(0.02)
    finer[1] = np.nan
    assert error(known) is None
    finer[1] = np.inf
    assert error(known) == np.inf
