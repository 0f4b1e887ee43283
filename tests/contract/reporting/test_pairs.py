"""Cells of a sweep compared in pairs on the same seeds: tables by axis, and the two ends of the order."""

from dataclasses import replace

import numpy as np
import pytest
from support.sample_sweep import measurements, noisy, two_axes

from runner.reporting.document import Table
from runner.reporting.sweep import distributions, question
from runner.reporting.sweep.subject import choose

ROBOTS = {"robot": ["macro", "xarm7"], "controller": ["computed_torque", "operational_space"]}


def robots(repetitions=8):
    """Errors of two laws on two robots; the law that is better on one is worse on the other."""
    error = noisy(lambda robot, law: 10.0**-robot * (1.0 + (0.5 if robot != law else 0.0)), repetitions)
    return choose(measurements(ROBOTS, {"rms": error}))


def tables(section, metric=0):
    """Return the tables of one of the metrics by the axis that each is about."""
    return {block.lines[0][1]: block for block in section.sections[metric].blocks if isinstance(block, Table)}


def test_laws_are_compared_within_each_robot():
    subject = robots()
    table = tables(question.pairs_section(subject))["controller"]
    assert [row[:2] for row in table.rows] == [
        [at, "computed_torque, operational_space"] for at in ("all", "robot=macro", "robot=xarm7")
    ]
    assert [row[-1] for row in table.rows] == ["larger", "larger", "smaller"]
    assert [row[4] for row in table.rows] == ["8", "8", "8"]  # n is where the interval does


def test_every_metric_that_is_compared_is_compared_in_pairs():
    subject = two_axes()
    section = question.pairs_section(subject)
    assert [part.title for part in section.sections] == ["Largest tracking error", "Largest torque"]
    for metric, _ in enumerate(subject.metrics):
        found = tables(section, metric)
        assert {axis: len(table.rows) for axis, table in found.items()} == {
            axis.name: 12 - 12 // len(axis.values) + len(axis.values) - 1 for axis in subject.axes
        }
    assert "p is corrected within the family (Holm)" in section.blocks[0].text


def test_cells_of_different_seeds_are_no_pair():
    subject = robots()
    apart = choose(replace(subject.measurements, seeds=[0, 0, 1, 1]))
    assert list(tables(question.pairs_section(apart))) == ["controller"]
    assert question.pairs_section(choose(replace(subject.measurements, seeds=range(4)))) is None


def test_swept_seeds_are_pooled_as_repetitions_are():
    grid = {"seed": [0.0, 1.0], "controller": ["a", "b"]}
    sample = measurements(grid, {"rms": noisy(lambda seed, law: 1.0 + law)})
    subject = choose(replace(sample, seeds=[0, 0, 1, 1]))
    table = tables(question.pairs_section(subject))["controller"]
    (row,) = table.rows
    assert (row[0], row[4]) == ("all", "16")
    assert table.caption.endswith("by controller, as the only axis, over all seeds.")


def test_of_many_pairs_some_are_shown_and_the_caption_says_so():
    grid = {"a": np.arange(10.0), "b": np.arange(10.0)}
    table = tables(question.pairs_section(choose(measurements(grid, {"rms": noisy(lambda a, b: 1.0 + a + b)}))))["a"]
    assert len(table.rows) == 9 + 24  # over all else, and some within
    assert "(24 of 90 pairs, spread evenly over the sweep)" in table.caption


def test_few_repetitions_have_no_interval_and_say_how_many_they_are():
    row = tables(question.pairs_section(robots(5)))["controller"].rows[0]
    assert row[3:5] == ["–", "5"]
    assert row[-1] == "too few pairs to say (5 of 6)"


def test_missing_repetitions_are_left_out_and_failed_ones_are_beyond_every_number():
    subject = robots()
    values = subject.measurements.values["rms"]
    values[0, :2], values[1, 2:] = np.nan, np.inf
    _, row, _ = tables(question.pairs_section(subject))["controller"].rows
    assert [row[2], *row[4:6]] == ["beyond every number", "6", "1.00"]
    values[1] = np.nan
    table = tables(question.pairs_section(subject))["controller"]
    assert [row[0] for row in table.rows] == ["all", "robot=xarm7"]
    assert "spread evenly" not in table.caption


@pytest.fixture(name="blocks")
def _blocks(monkeypatch):
    """Return the blocks on the first and the last cell, whose runs are not stored: no motion is shown."""
    monkeypatch.setattr(distributions, "motion_blocks", lambda _: [])
    return lambda subject: distributions.extremes_section(subject, {}).blocks


def test_n_stands_beside_the_intervals_of_both_ends(blocks):
    table = blocks(robots())[0]
    assert all(cell.endswith(", n = 8)") for cell in table.rows[0][1:])
    few = blocks(robots(5))[0]
    assert all(cell.endswith("(n = 5)") for cell in few.rows[0][1:])
