"""Runs that patterns of levels stand for, and what is made of them."""

import pytest
from support.made_up_runs import made_up_metric, made_up_run, planned

from runner.base.errors import RunnerError
from runner.papers.study.check import never_failing
from runner.papers.study.measured import Measured
from runner.papers.study.prose import read_chapter
from runner.papers.study.prose.blocks import each, named
from runner.papers.study.prose.plots import line
from runner.papers.study.prose.tables import listing
from runner.papers.study.results import LeftOutError, Results, matching_runs

PATHS = ["line/a/1", "line/a/2", "line/b/1", "line/c/1", "circle/a/1"]
RUNS = planned("{path}/{plant.case}/{number}", dict.fromkeys(PATHS))


def names(pattern, by=(), runs=RUNS):
    return [each.name for each in matching_runs(runs, pattern, by)]


def test_an_axis_stands_for_each_of_its_levels_in_the_order_of_the_plan():
    assert names("line/{case}/1") == ["line/a/1", "line/b/1", "line/c/1"]
    assert names("{path}/{plant.case}/1", ["plant.case"]) == ["line/a/1", "circle/a/1", "line/b/1", "line/c/1"]


def test_an_axis_with_levels_stands_for_these_alone_in_their_order():
    assert names("line/{case=c|a}/{number}") == ["line/c/1", "line/a/1", "line/a/2"]


@pytest.mark.parametrize(
    ("pattern", "told"),
    [
        ("line/{case=c|bb}/1", r"axis 'case' has no level 'bb' \(did you mean b\?\); levels: a, b, c"),
        ("line/{cas}/1", r"no axis 'cas' \(did you mean case\?\); axes: plant.case"),
        ("line/{ant.case}/1", "no axis 'ant.case'"),
        ("line/case {case}/1", "an axis is a whole part of a name; found 'case {case}'"),
        ("lin/{case}/1", r"no run is named like 'lin/\{case\}/1' \(did you mean line/c/1\?\)"),
        ("line/{case}", "no run is named like"),
    ],
)
def test_a_pattern_for_which_there_is_no_run_is_refused(pattern, told):
    with pytest.raises(RunnerError, match=told):
        matching_runs(RUNS, pattern)


def test_a_level_may_hold_a_slash_and_a_word_is_no_level():
    parts = {"at/a/b": (("", "at"), ("file", "a/b")), "at/rk4": (("", "at"), ("", "rk4"))}
    runs = Results(dict.fromkeys(parts), parts=parts)
    assert names("at/{file}", runs=runs) == names("at/{file=a/b}", runs=runs) == ["at/a/b"]


def test_runs_that_the_profile_leaves_out_are_not_found_and_say_so_where_none_is_left():
    parts = {name: (("case", name),) for name in "abc"}
    runs = Results({"a": None}, dropped={"b": "not in quick", "c": "not in quick"}, parts=parts)
    assert names("{case}", runs=runs) == names("{case=b|a}", runs=runs) == ["a"]
    with pytest.raises(LeftOutError, match="b: not in quick"):
        matching_runs(runs, "{case=b|c}")


def test_levels_are_those_of_names_that_begin_with_a_word():
    assert (RUNS.levels("line", "case"), RUNS.levels("circle", "plant.case")) == (["a", "b", "c"], ["a"])


def test_a_listing_shows_texts_and_numbers_as_they_are():
    length = Measured("length", 0.4, "m")
    table = listing({}, "Caption", "", ["what", "how much"], ["length", length], ["way", 2e-15], ["time", None])
    assert table.lines[1:] == [["length", "0.4"], ["way", "0 (rounding)"], ["time", "–"]]
    assert [column.kind for column in table.columns] == ["text", "number"]


def run_of(value, failed=False):
    """Return a run with an error and a motion of that length."""
    motion = {"t": [0.0, 1.0], "tip_x": [0.0, value], "tip_y": [2.0, 3.0]}
    return made_up_run({"error": made_up_metric(value)}, motion, failed=failed)


def test_each_run_gives_a_value_that_conditions_call_by_words_with_axes_or_by_its_name():
    runs = planned("line/{rate}", {"line/1": run_of(0.5), "line/2": run_of(0.7, failed=True)})
    found = each(runs, "error at {rate} Hz", "error", "m", "line/{rate}")
    assert [(one.name, one.value, one.unit) for one in found] == [
        ("error at 1 Hz", 0.5, "m"),
        ("error at 2 Hz", None, "m"),
    ]
    (twice,) = each(runs, "twice the error", lambda one: 2.0 * one.metrics["error"].median, "m", "line/1")
    assert (twice.name, twice.value) == ("twice the error of line/1", 1.0)
    slow, _ = each(runs, "error, {rate}", "error", "m", "line/{rate}", levels={"1": "slow"})
    assert slow.name == "error, slow"


def test_a_signal_is_drawn_over_another_one():
    (series,) = line({"line/1": run_of(0.5)}, "line/1", "tip_x", x="tip_y")
    assert (series.x.tolist(), series.y.tolist()) == ([2.0, 3.0], [0.0, 0.5])


def test_values_in_a_group_are_changed_too():
    names = {"values": lambda: {"error": named("error", 1.0, "m")}}
    chapter = "# T\n\n{% set own = values() %}\n\n::: finding A\nB.\nholds: own.error < 2\n:::\n"
    assert never_failing("chapter.md", read_chapter("chapter.md", chapter, names)) == []
