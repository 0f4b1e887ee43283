"""Cells of sweeps matched by the values of their axes."""

from dataclasses import replace

import pytest
from support.sample_sides import LAWS, side

from runner.base.errors import RunnerError
from runner.reporting.comparison.pairs import keep_common_seeds, label_text, match


def nothing(*_):
    return 1.0


def test_cells_are_matched_by_what_either_sweeps():
    matched = match(side("A", LAWS, nothing), side("B", {**LAWS, "gravity": [9.81, 9.4]}, nothing))
    assert list(matched.keys) == ["robot", "gravity"]
    assert [label_text(label) for label in matched.labels] == [
        "robot=macro, gravity=9.81",
        "robot=xarm7, gravity=9.81",
    ]
    assert (matched.of_a.tolist(), matched.of_b.tolist()) == ([1, 3], [0, 2])
    assert [label["gravity"] for label in matched.alone[0]] == ["9.6", "9.6"]
    assert [label["gravity"] for label in matched.alone[1]] == ["9.4", "9.4"]


def test_a_key_that_one_fixes_is_matched():
    a, b = side("A", LAWS, nothing), side("B", {"robot": ["xarm7"], "gravity": [9.6, 9.81]}, nothing)
    assert [label["robot"] for label in match(a, b).labels] == ["xarm7", "xarm7"]


def test_a_key_that_one_leaves_as_it_is_is_matched_by_its_resolved_value():
    left = side("B", {"robot": ["macro", "xarm7"]}, nothing, gravity=9.81)
    assert [label["gravity"] for label in match(side("A", LAWS, nothing), left).labels] == ["9.81", "9.81"]
    option = side("B", {"gravity": [9.6, 9.81]}, nothing, robot={"name": "macro", "tip": "flange"})
    assert [label["robot"] for label in match(side("A", LAWS, nothing), option).labels] == ["macro", "macro"]


def test_a_value_is_the_same_however_it_is_written():
    a = side("A", {"gravity": [1e-4, 0.5]}, nothing)
    b = side("B", {"gravity": [0.0001, 5e-1]}, nothing)
    assert len(match(a, b).labels) == 2


def test_equal_cells_are_matched_in_turn():
    a = side("A", LAWS, nothing)
    twice = side("B", LAWS, nothing, order=[0, 0, 1, 2, 3])
    matched = match(twice, a)
    assert matched.of_b.tolist() == [0, 1, 2, 3]
    assert [label_text(label) for label in matched.alone[0]] == ["robot=macro, gravity=9.6"]


def test_sweeps_that_share_no_cell_are_refused_with_where_they_part():
    a, b = side("A", LAWS, nothing), side("B", {**LAWS, "gravity": [9.4, 9.3]}, nothing)
    with pytest.raises(RunnerError, match=r"share no cell: gravity is 9.6, 9.81 in A and 9.4, 9.3 in B; sweep both"):
        match(a, b)
    first = side("A", LAWS, nothing, order=[0, 3])
    second = side("B", LAWS, nothing, order=[1, 2])
    with pytest.raises(RunnerError, match="no combination of robot, gravity is in both"):
        match(first, second)


def test_other_seeds_share_no_noise():
    a, b = side("A", LAWS, nothing), side("B", LAWS, nothing, seed=1)
    with pytest.raises(RunnerError, match="have 4 cells in common, but no seed"):
        keep_common_seeds(match(a, b))
    matched = keep_common_seeds(match(a, replace(b, seeds=[0, 1, 0, 1])))
    assert (len(matched.labels), matched.other_seeds) == (2, 2)
