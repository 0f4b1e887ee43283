"""Two sweeps compared: counts, differences and cells against sides whose values are given."""

from dataclasses import replace

import numpy as np
import pytest
from support.sample_sides import LAWS, side

from runner.base.errors import RunnerError
from runner.base.quantities import ROUNDING
from runner.reporting.asked import ask
from runner.reporting.comparison.pairs import match
from runner.reporting.comparison.sweeps import compare_sweeps, counts_by_sign, noise_alone
from runner.statistics import compare_paired


def error(robot, gravity):
    return {"macro": 0.01, "xarm7": 0.1}[robot] + gravity


def shifted(robot, gravity):
    return error(robot, gravity) + 0.25


def by_cell(found, metric):
    return ask(list(found.pairs.each()), [metric])


def named(found):
    """Return the pooled answers by metric."""
    return {one.metric: one for one in found if not one.at}


def pooled(a, b, metric="rms_tracking_error"):
    """Return the pooled comparison of two sweeps, whether or not it describes their cells."""
    return ask([match(a, b)], [metric])[0]


def test_identical_sweeps_differ_by_zero_in_every_metric():
    found = compare_sweeps(side("A", LAWS, error), side("B", LAWS, error))
    assert set(named(found.answers)) == {"rms_tracking_error", "peak_torque_q1"}
    for one in found.answers:
        assert (one.comparison.difference, one.comparison.interval(0.05), one.comparison.n) == (0.0, (0.0, 0.0), 8)
        assert (one.comparison.effect, one.comparison.p_value) == (0.0, 1.0)
        assert counts_by_sign(one) == (0, 0)
    assert found.cells == []
    assert found.differences.in_words("A", "B") == "A and B differ in no value."


def test_a_known_shift_is_found_over_all_cells_and_in_each():
    found = compare_sweeps(side("A", LAWS, error), side("B", LAWS, shifted))
    one = named(found.answers)["rms_tracking_error"]
    assert one.comparison.difference == pytest.approx(0.25)
    assert one.comparison.effect == 1.0
    assert counts_by_sign(one) == (0, 4)
    assert [cell.comparison.difference for cell in by_cell(found, "rms_tracking_error")] == pytest.approx([0.25] * 4)


@pytest.mark.parametrize(
    ("moved", "counts"),
    [
        (ROUNDING, (0, 0)),
        (np.nextafter(ROUNDING, 1.0), (0, 4)),
        (-ROUNDING, (0, 0)),
        (np.nextafter(-ROUNDING, -1.0), (4, 0)),
    ],
    ids=["rounding", "above rounding", "minus rounding", "below minus rounding"],
)
def test_cells_whose_median_moves_by_rounding_alone_count_on_neither_side(moved, counts):
    a, b = side("A", LAWS, error), side("B", LAWS, error)
    a.values["rms_tracking_error"][:] = 0.0
    b.values["rms_tracking_error"][:] = moved
    assert counts_by_sign(pooled(a, b)) == counts


def test_the_order_of_cells_and_keys_does_not_count():
    a, b = side("A", LAWS, error), side("B", LAWS, shifted)
    turned = side("B", dict(reversed(LAWS.items())), lambda gravity, robot: shifted(robot, gravity), order=[3, 1, 0, 2])
    draws = a.values["rms_tracking_error"]
    turned.values["rms_tracking_error"][:] = draws[[3, 2, 0, 1]] + 0.25  # the noise of the same cell
    expected, found = compare_sweeps(a, b), compare_sweeps(a, turned)
    for one, other in zip(expected.answers, found.answers, strict=True):
        assert one.comparison.difference == pytest.approx(other.comparison.difference)
        assert one.comparison.effect == other.comparison.effect
    assert found.pairs.labels == expected.pairs.labels


def test_swapping_the_two_negates():
    a, b = side("A", LAWS, error), side("B", LAWS, lambda robot, gravity: error(robot, gravity) * 1.1)
    there, back = compare_sweeps(a, b), compare_sweeps(b, a)
    for one, other in zip(there.answers, back.answers, strict=True):
        assert one.comparison.difference == -other.comparison.difference
        assert one.comparison.effect == -other.comparison.effect
        assert one.comparison.p_value == other.comparison.p_value
        assert counts_by_sign(one) == counts_by_sign(other)[::-1]
        assert one.comparison.medians == other.comparison.medians[::-1]


def test_the_pooled_comparison_is_that_of_the_means_of_all_cells():
    a, b = side("A", LAWS, error), side("B", LAWS, shifted, order=[2, 0, 3, 1])
    values = [one.values["rms_tracking_error"] for one in (a, b)]
    one = pooled(a, b)
    expected = compare_paired(values[0].mean(axis=0), values[1].mean(axis=0))
    assert one.comparison.differences == pytest.approx(expected.differences)
    assert one.comparison.b == pytest.approx(expected.b)


def test_cells_with_the_largest_differences_are_named_in_relation_to_their_size():
    def moved(robot, gravity):
        return error(robot, gravity) + {"macro": 1.0, "xarm7": 0.0}[robot] * (1.0 if gravity > 9.7 else -2.0)

    found = compare_sweeps(side("A", LAWS, error), side("B", LAWS, moved))
    first, second = found.cells
    assert (first.at, first.comparison.effect) == ({"robot": "macro", "gravity": "9.6"}, -1.0)
    assert (second.at, second.comparison.effect) == ({"robot": "macro", "gravity": "9.81"}, 1.0)
    assert found.candidates == 4  # of the metric that is not a joint's


def test_cells_of_opposite_sign_are_counted():
    def opposite(robot, gravity):
        return error(robot, gravity) + {"macro": 0.5, "xarm7": -0.5}[robot]

    a, b = side("A", LAWS, error), side("B", LAWS, opposite)
    assert counts_by_sign(pooled(a, b)) == (2, 2)
    assert named(compare_sweeps(a, b).answers).keys() == {"peak_torque_q1"}  # no pooled number describes these


def test_fewer_repetitions_on_one_side_are_compared_as_far_as_they_go():
    a, b = side("A", LAWS, error, repetitions=8), side("B", LAWS, shifted, repetitions=6)
    assert named(compare_sweeps(a, b).answers)["rms_tracking_error"].comparison.n == 6


def test_failed_and_missing_values():
    a, b = side("A", LAWS, error), side("B", LAWS, error)
    b.values["rms_tracking_error"][0] = np.inf
    b.values["rms_tracking_error"][1] = np.nan
    found = compare_sweeps(a, b)
    one = pooled(a, b)
    assert one.comparison.n == 8
    assert counts_by_sign(one) == (0, 1)
    assert found.cells[0].comparison.difference == np.inf
    assert len(by_cell(found, "rms_tracking_error")) == 3


def test_spread_is_more_than_noise():
    a, b = side("A", LAWS, error), side("B", LAWS, error)
    assert noise_alone([a, b])
    spread = side("B", LAWS, error, mismatch={"spread": 0.1})
    assert not noise_alone([a, spread])


def test_sweeps_without_a_common_metric_and_unknown_ones_are_refused():
    a, b = side("A", LAWS, error), side("B", LAWS, error)
    other = replace(b, values={})
    with pytest.raises(RunnerError, match="A and B have no metric in common"):
        compare_sweeps(a, other)
    with pytest.raises(RunnerError, match=r"unknown metric 'rms'\. Allowed: rms_tracking_error, "):
        compare_sweeps(a, b, ["rms"])
    assert list(named(compare_sweeps(a, b, ["peak_torque_q1"]).answers)) == ["peak_torque_q1"]


def test_each_rule_is_counted_and_its_worst_is_told():
    def caveat(rule, value):
        return {"rule": rule, "text": f"{rule} {value}", "value": value}

    one = side("A", LAWS, lambda *_: 1.0)
    found = [
        [caveat("chatter", 0.2)],
        [caveat("saturation", 0.1), caveat("chatter", 0.9)],
        [],
        [caveat("chatter", 0.3)],
    ]
    assert one.caveats_by_rule() == []
    assert replace(one, caveats=found).caveats_by_rule() == [
        ("chatter", 3, 1, "chatter 0.9"),
        ("saturation", 1, 1, "saturation 0.1"),
    ]
