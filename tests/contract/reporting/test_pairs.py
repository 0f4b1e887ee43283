"""Cells of a sweep compared in pairs on the same seeds: the full tables, and the two ends of the order."""

from collections import defaultdict
from dataclasses import replace

import numpy as np
import pytest
from support.sample_sweep import measurements, noisy

from runner.reporting.document import Table
from runner.reporting.sweep import distributions
from runner.reporting.sweep.question import find_answers, pairs_section
from runner.reporting.sweep.subject import choose

ROBOTS = {"robot": ["macro", "xarm7"], "controller": ["computed_torque", "operational_space"]}


def robots(repetitions=8):
    """Errors of two laws on two robots; the law that is better on one is worse on the other."""
    error = noisy(lambda robot, law: 10.0**-robot * (1.0 + (0.5 if robot != law else 0.0)), repetitions)
    return choose(measurements(ROBOTS, {"rms": error}))


def table(subject, metric=0):
    """Return the table of one of the metrics."""
    blocks = pairs_section(find_answers(subject)).sections[metric].blocks
    return next(block for block in blocks if isinstance(block, Table))


def test_laws_are_compared_within_each_robot_and_not_pooled_where_they_contradict():
    rows = table(robots()).rows
    laws = "computed_torque, operational_space"
    assert [row[:2] for row in rows] == [["robot=macro", laws], ["robot=xarm7", laws]]
    assert [row[-1] for row in rows] == ["larger", "smaller"]
    assert [row[4] for row in rows] == ["8", "8"]  # n is where the interval does


def test_cells_of_different_seeds_are_no_pair():
    subject = robots()
    assert find_answers(choose(replace(subject.measurements, seeds=range(4)))) == []
    assert pairs_section([]) is None


def test_swept_seeds_are_pooled_as_repetitions_are():
    grid = {"seed": [0.0, 1.0], "controller": ["a", "b"]}
    sample = measurements(grid, {"rms": noisy(lambda seed, law: 1.0 + law)})
    (row,) = table(choose(replace(sample, seeds=[0, 0, 1, 1]))).rows
    assert (row[0], row[4]) == ("all", "16")


def test_of_many_conditions_some_are_shown_and_the_caption_says_so():
    grid = {"noise.position": np.arange(1.0, 41.0), "controller": ["a", "b"]}
    found = table(choose(measurements(grid, {"rms": noisy(lambda noise, law: 1.0 + law, 16)})))
    assert len(found.rows) == 24
    assert "(24 of 41, spread evenly)" in found.caption


def test_missing_repetitions_are_left_out_and_failed_ones_are_beyond_every_number():
    subject = robots(10)
    values = subject.measurements.values["rms"]
    values[0, :2], values[1, 2:] = np.nan, np.inf
    macro, _ = table(subject).rows
    assert [macro[2], *macro[4:6]] == ["beyond every number", "8", "1.00"]


@pytest.fixture(name="blocks")
def _blocks(monkeypatch):
    """Return the blocks on the first and the last cell, whose runs are not stored: no motion is shown."""
    monkeypatch.setattr(distributions, "motion_blocks", lambda *_: [])

    def made(subject):
        shown = distributions.choose_cells(subject, subject.ranked)
        return distributions.extremes_section(subject, shown, defaultdict(lambda: None)).blocks

    return made


def test_n_stands_beside_the_intervals_of_both_ends(blocks):
    found = blocks(robots())[0]
    assert all(cell.endswith(", n = 8)") for cell in found.rows[0][1:])
    few = blocks(robots(5))[0]
    assert all(cell.endswith("(n = 5)") for cell in few.rows[0][1:])
