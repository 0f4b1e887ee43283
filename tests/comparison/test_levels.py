"""Levels of an axis compared within one sweep, against shifts that are put in."""

from dataclasses import replace

import numpy as np
import pytest

from runner.comparison.levels import level_pairs, levels
from runner.errors import RunnerError
from runner.statistics import compare_paired
from runner.sweeps.measurements import Axis, Measurements


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


def test_each_level_is_compared_with_the_first_within_each_level_of_the_other_axis():
    sweep = grid(LAWS, lambda robot, law: 10.0 * robot + law)
    found = levels(sweep, "controller")
    assert [(one.pair.at, one.pair.first, one.pair.second) for one in found] == [
        ({"robot": robot}, "a", law) for robot in ("macro", "xarm7") for law in ("b", "c")
    ]
    values = sweep.values["rms"]
    assert found[3].comparison == compare_paired(values[3], values[5])
    assert (found[3].axis, found[3].metric, found[3].unit) == ("controller", "rms", "m")


def test_a_known_shift_is_found_and_none_is_none():
    shifted = grid(LAWS, lambda robot, law: 0.0)
    shifted.values["rms"][:] = shifted.values["rms"][0] + 0.25 * shifted.axes[1].level[:, None]
    for one in levels(shifted, "controller"):
        expected = 0.25 if one.pair.second == "b" else 0.5
        assert one.comparison.difference.median == pytest.approx(expected)
        assert one.comparison.effect == 1.0
    for one in levels(shifted, "robot"):
        assert (one.comparison.difference.median, one.comparison.effect) == (0.0, 0.0)
        assert one.comparison.verdict == "no difference shown"


def test_axes_that_are_not_named_are_pooled_pair_by_pair():
    axes = {"robot": ["macro", "xarm7"], "noise": [1e-3, 1e-2, 1e-1], "controller": ["a", "b"]}
    sweep = grid(axes, lambda robot, noise, law: 100.0 * robot + 7.0 * noise + law)
    one, other = levels(sweep, "controller", within=["robot"])
    values = sweep.values["rms"]
    assert one.comparison == compare_paired(values[0:6:2].ravel(), values[1:6:2].ravel())
    assert (other.pair.at, other.comparison.difference.n) == ({"robot": "xarm7"}, 24)
    # What the pooled axis does to both is no difference: the shift is one, whatever the noise does.
    assert other.comparison.difference.median == pytest.approx(1.0, abs=5e-3)


def test_a_swept_seed_is_pooled_like_repetitions_and_can_be_asked_for():
    axes = {"seed": [0.0, 1.0, 2.0], "controller": ["a", "b"]}
    sweep = grid(axes, lambda seed, law: seed + law, seeds=[0, 0, 1, 1, 2, 2], repetitions=1)
    (pooled,) = levels(sweep, "controller")
    assert (pooled.pair.at, pooled.comparison.difference.n) == ({}, 3)
    assert [one.pair.at["seed"] for one in levels(sweep, "controller", within=["seed"])] == ["0", "1", "2"]
    with pytest.raises(RunnerError, match="share their seed"):
        levels(sweep, "seed")


def test_cells_of_different_seeds_are_no_pair():
    sweep = grid(LAWS, lambda robot, law: law)
    apart = replace(sweep, seeds=np.array([0, 1, 0, 0, 0, 0]))
    assert [one.pair.second for one in levels(apart, "controller")] == ["c", "b", "c"]


def test_cells_that_are_missing_are_left_out():
    sweep = grid({"robot": ["macro", "xarm7"], "controller": ["a", "b"]}, lambda robot, law: law)
    sweep.values["rms"][2] = np.nan
    assert [one.pair.at for one in levels(sweep, "controller")] == [{"robot": "macro"}]
    listed = replace(sweep, axes=[replace(axis, level=axis.level[:3]) for axis in sweep.axes], hashes=sweep.hashes[:3])
    assert [pair.at for pair in level_pairs(listed, "controller")] == [{"robot": "macro"}]


def test_very_many_pairs_are_drawn_from_and_n_says_so():
    sweep = grid({"seed": np.arange(3000.0), "controller": ["a", "b"]}, lambda seed, law: law, repetitions=2)
    (found,) = levels(sweep, "controller")
    assert found.comparison.difference.n == 5000
    assert found.comparison.difference.median == pytest.approx(1.0, abs=1e-3)
    assert levels(sweep, "controller")[0].comparison == found.comparison


@pytest.mark.parametrize(
    ("axis", "within", "metrics", "message"),
    [
        ("controler", (), (), "no axis 'controler' (did you mean controller?); it was swept over: robot, controller"),
        ("controller", ("robt",), (), "no axis 'robt' (did you mean robot?)"),
        ("controller", ("controller",), (), "controller: is compared"),
        ("controller", (), ("rsm",), "the runs have no metric 'rsm' (did you mean rms?); known: rms"),
    ],
)
def test_unknown_names_are_refused(axis, within, metrics, message):
    with pytest.raises(RunnerError) as caught:
        levels(grid(LAWS, lambda robot, law: law), axis, within, metrics)
    assert message in str(caught.value)
