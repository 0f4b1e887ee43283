"""Numbers that chapters read of runs: ends of metrics, settings, abscissae, and values of a run until it failed."""

from dataclasses import replace

import numpy as np
import pytest
from support.made_up_runs import planned

from runner.papers.study.measured import Measured
from runner.papers.study.prose import read_chapter
from runner.papers.study.prose.blocks import metric, percent, round_to
from runner.papers.study.prose.plots import over
from runner.papers.study.prose.signals import setting
from runner.papers.study.prose.tables import column, level, table
from runner.papers.study.results import MissingError, Results
from runner.sweeps.job import run


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("outputs")
    steps = {"step/3.0/slow": 0.01, "step/3.5/slow": 0.005}
    made = {
        name: run("robot=macro", "duration=0.02", "repetitions=2", f"controller.period={period}", f"outputs={folder}")
        for name, period in steps.items()
    }
    failed = made["step/3.5/slow"]
    made["step/3.5/slow"] = replace(failed, record={**failed.record, "status": "failed", "metrics": {}})
    return planned("step/{case}/slow", made)


def period(one):
    return one.config["controller"]["period"]


def test_a_metric_has_ends(runs):
    name, stored = "steady_state_error", runs["step/3.0/slow"].metrics["steady_state_error"]
    values = [metric(runs, "step/3.0/slow", name, "error", end).value for end in ("min", "median", "max")]
    assert values == [stored.min, stored.median, stored.max]
    assert metric(runs, "step/3.5/slow", name, "error", "max").value is None


def test_shares_digits_and_settings(runs):
    assert percent(Measured("share", 0.25)) == Measured("share", 25.0, "%")
    assert percent(Measured("share", None)).value is None
    assert (round_to(Measured("length", 0.031416, "m"), 4), round_to(0.031416, 2)) == ("31.42 mm", "0.031")
    assert setting("controller.period", 1000.0)(runs["step/3.0/slow"]) == 10.0


def test_what_a_failed_run_gave_is_shown_where_asked_for(runs):
    told = table(
        runs,
        "Periods",
        "step/{case}/slow",
        level("case"),
        column("p", period),
        column("p", period, though_failed=True),
    )
    assert [list(row) for row in told.lines[1:]] == [["3", "0.01", "0.01"], ["3.5", "failed", "5·10⁻³"]]
    (hidden,), (shown,) = (
        over(runs, "step/{case}/slow", "case", period, x=setting("controller.period", 1000.0), though_failed=asked)
        for asked in (False, True)
    )
    np.testing.assert_array_equal(hidden.x, [10.0, 5.0])
    np.testing.assert_array_equal(hidden.y, [0.01, np.nan])
    np.testing.assert_array_equal(shown.y, [0.01, 0.005])


def test_a_chapter_without_its_run_says_which_was_not_made():
    made = Results({}, {"step": "cut short"})
    with pytest.raises(MissingError, match="step: cut short"):
        read_chapter("chapter.md", "# Title\n\n{{ step() }}", {"step": lambda: made["step"]})
