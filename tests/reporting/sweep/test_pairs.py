from dataclasses import replace

import numpy as np
from sample_sweep import measurements, noisy, two_axes

from runner.reporting.document import Table
from runner.reporting.sweep import extremes, pairs
from runner.reporting.sweep.subject import choose
from runner.statistics import compare_paired

ROBOTS = {"robot": ["macro", "xarm7"], "controller": ["computed_torque", "operational_space"]}


def robots(repetitions=8):
    """Errors of two laws on two robots; the law that is better on one is worse on the other."""
    error = noisy(lambda robot, law: 10.0**-robot * (1.0 + (0.5 if robot != law else 0.0)), repetitions)
    return choose(measurements(ROBOTS, {"rms": error}))


def tables(section):
    return {block.header[1]: block for block in section.blocks if isinstance(block, Table)}


def test_laws_are_compared_within_each_robot():
    subject = robots()
    table = tables(pairs.section(subject))["controller"]
    assert [row[:2] for row in table.rows] == [
        ["robot=macro", "computed_torque, operational_space"],
        ["robot=xarm7", "computed_torque, operational_space"],
    ]
    assert [row[-1] for row in table.rows] == ["larger", "smaller"]
    assert [row[4] for row in table.rows] == ["8", "8"]  # n stands where the interval does


def test_every_pair_differs_in_one_axis_alone():
    subject = two_axes()
    for axis in subject.axes:
        found = pairs.pairs(subject, axis)
        assert len(found) == 12 - 12 // len(axis.values)
        for a, b in found:
            assert axis.level[a] == 0 < axis.level[b]
            assert all(other is axis or other.level[a] == other.level[b] for other in subject.axes)


def test_a_comparison_is_that_of_the_two_cells():
    subject = robots()
    values = subject.measurements.values["rms"]
    assert pairs.compare(subject, "rms", 0, 1) == compare_paired(values[0], values[1])


def test_cells_of_different_seeds_are_no_pair():
    subject = robots()
    apart = choose(replace(subject.measurements, seeds=[0, 0, 1, 1]))
    assert list(tables(pairs.section(apart))) == ["controller"]
    assert pairs.section(choose(replace(subject.measurements, seeds=range(4)))) is None


def test_over_seeds_pairs_are_found_within_each_seed():
    grid = {"seed": [0.0, 1.0], "controller": ["a", "b"]}
    sample = measurements(grid, {"rms": noisy(lambda seed, law: 1.0 + law)})
    subject = choose(replace(sample, seeds=[0, 0, 1, 1]))
    assert [row[0] for row in tables(pairs.section(subject))["controller"].rows] == ["seed=0", "seed=1"]


def test_of_many_pairs_some_are_shown_and_the_caption_says_so():
    grid = {"a": np.arange(10.0), "b": np.arange(10.0)}
    table = tables(pairs.section(choose(measurements(grid, {"rms": noisy(lambda a, b: 1.0 + a + b)}))))["a"]
    assert len(table.rows) == 24
    assert "(24 of 90 pairs, spread evenly over the sweep)" in table.caption


def test_few_repetitions_have_no_interval_and_say_how_many_they_are():
    row = tables(pairs.section(robots(5)))["controller"].rows[0]
    assert row[3:5] == ["–", "5"]
    assert row[-1] == "too few pairs to say (5 of 6)"


def test_missing_repetitions_are_left_out_and_failed_ones_are_beyond_every_number():
    subject = robots()
    values = subject.measurements.values["rms"]
    values[0, :2], values[1, 2:] = np.nan, np.inf
    row = tables(pairs.section(subject))["controller"].rows[0]
    assert row[2:5] == ["beyond every number", "never to never", "6"]
    values[1] = np.nan
    table = tables(pairs.section(subject))["controller"]
    assert len(table.rows) == 1
    assert "spread evenly" not in table.caption


def test_n_stands_beside_the_intervals_of_best_and_worst():
    table = extremes._medians(robots(), [2, 1])
    assert all(cell.endswith("n = 8)") for cell in table.rows[0][1:])
