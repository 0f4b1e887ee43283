"""Caveats that a study expects, against those of runs invented here."""

from dataclasses import replace
from pathlib import Path

import pytest
from support.made_up_runs import made_up_metric, made_up_run

from runner.base.errors import RunnerError
from runner.config.judgement import THRESHOLDS
from runner.papers.study.expected_caveats import (
    ExpectedCaveat,
    caveats_as_data,
    caveats_section,
    unexpected_caveats,
)
from runner.papers.study.results import Results
from runner.papers.study.run_values import measured
from runner.papers.study.study import load_study
from runner.reporting.document import Notice, Table


def run_with(*rules):
    """Return a run with caveats by rule and value."""
    caveats = [{"rule": rule, "text": f"{rule} of {value:g} $", "value": value} for rule, value in rules]
    return replace(made_up_run(caveats=caveats), folder=Path(f"{rules}"))


RUNS = {
    "fast/full_equations": run_with(("saturation", 0.4)),
    "fast/as_reported": run_with(("saturation", 0.6), ("chatter", 0.2)),
    "slow/full_equations": run_with(),
}
CHATTERS = ExpectedCaveat("chatter", "*/as_reported", "Noise.")
SATURATED = ExpectedCaveat("saturation", "fast/*", "The limit is what the section is about.")


def test_a_caveat_is_expected_of_the_runs_that_a_pattern_names():
    assert unexpected_caveats(RUNS, [SATURATED, CHATTERS]) == []
    lines = unexpected_caveats(RUNS, [SATURATED])
    assert lines == ["fast/as_reported: caveat chatter, which the study does not expect: chatter of 0.2 $"]
    assert len(unexpected_caveats(RUNS, [ExpectedCaveat("saturation", "fast/full_equations", "Why.")])) == 2


def test_the_section_tells_how_many_and_the_worst_and_warns_of_others():
    warning, table = caveats_section(RUNS, [SATURATED, ExpectedCaveat("overload", "*", "Nothing has it.")]).blocks
    assert isinstance(warning, Notice)
    assert warning.title == "1 caveat that this study does not expect"
    assert isinstance(table, Table)
    assert table.rows == [["saturation", "2", "fast/as_reported: saturation of 0.6 $$", SATURATED.why]]


def test_a_run_of_two_names_is_counted_once():
    (table,) = caveats_section({**RUNS, "fast/again": RUNS["fast/full_equations"]}, [SATURATED, CHATTERS]).blocks
    assert [row[:2] for row in table.rows] == [["saturation", "2"], ["chatter", "1"]]


def test_a_study_without_caveats_says_so():
    (text,) = caveats_section({"slow/full_equations": run_with()}, []).blocks
    assert text.text == "No rule found anything at the end of the runs."


def test_programs_get_every_caveat_with_why_it_is_expected():
    told = caveats_as_data(RUNS, [SATURATED])
    assert [(each["run"], each["rule"], each["expected"]) for each in told] == [
        ("fast/full_equations", "saturation", SATURATED.why),
        ("fast/as_reported", "saturation", SATURATED.why),
        ("fast/as_reported", "chatter", None),
    ]


@pytest.mark.parametrize("study", ["thesis", "thesis_beyond", "xarm7", "meca500", "engines"])
def test_what_a_study_expects_is_of_known_rules_and_of_runs_that_it_has(study):
    made = load_study(study)
    names = made.jobs()
    rules = set(THRESHOLDS)
    for expected in made.expected:
        assert expected.rule in rules
        assert any(expected.covers(name, {"rule": expected.rule}) for name in names), expected
        assert expected.why.endswith(".")


def test_a_run_that_a_study_does_not_have_is_refused_with_the_nearest_name():
    made = Results({"figure_3_5/full_equations": run_with()}, {"figure_3_6/full_equations": "not begun"})
    with pytest.raises(
        RunnerError,
        match=r"no run or calibration 'figure_3_5/full_equation' \(did you mean figure_3_5/full_equations\?\)",
    ):
        made["figure_3_5/full_equation"]


def test_a_metric_that_a_run_does_not_have_is_refused_with_the_nearest_name():
    ran = made_up_run({"settling_time": made_up_metric(1.0, unit="s")})
    with pytest.raises(RunnerError, match=r"run run has no metric 'setling_time' \(did you mean settling_time\?\)"):
        measured(ran, "setling_time", "time")


def test_a_failed_run_has_no_values():
    failed = made_up_run(failed=True)
    assert measured(failed, "settling_time", "time").value is None
