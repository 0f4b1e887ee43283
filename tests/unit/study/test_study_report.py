"""A study whose report lacks some of its runs: parts that need them say so, the rest is complete."""

import pytest

from runner.base.errors import RunnerError
from runner.papers.study.chapters import parts
from runner.papers.study.results import MissingError, Results
from runner.reporting.document import Section, Text

RUNS = Results({"a": 1, "b": 2}, {"c": "cut short: killed for $5"})


def section(name):
    return Section(name, (Text(f"{RUNS[name]}"),))


def test_what_was_not_made_is_said_where_it_is_asked_for():
    with pytest.raises(MissingError, match="c: cut short: killed"):
        RUNS["c"]
    with pytest.raises(RunnerError, match="no run or calibration 'd'"):
        RUNS["d"]
    assert list(RUNS.values()) == [1, 2]


def test_a_part_that_needs_it_is_left_out():
    arms, wrist = parts([("arms.md", lambda: section("a")), ("wrist.md", lambda: section("c"))])
    assert arms.title == "a"
    assert wrist.title == "Left out: wrist.md"
    assert wrist.blocks[0].text == "This part needs what was not made: c: cut short: killed for $$5."
