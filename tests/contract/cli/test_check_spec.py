"""`runner check` of runs with a spec, and the lines on the spec at the end of a run."""

import re

import numpy as np
import pytest
from fixtures.stored import DRAWN

from runner.reporting import outline
from runner.reporting.document import Table
from runner.reporting.run_report import run_document
from runner.store import open_run

BOUND = "spec.metrics.cross_track_error.max"


@pytest.fixture
def cut(copy_run):
    """Return a bound that this many of the 40 repetitions break, which are stored without one."""
    values = np.sort(open_run(copy_run("rk4")).values("cross_track_error"))
    return lambda failing: f"{BOUND}={float(values[39 - failing] + values[min(40 - failing, 39)]) / 2}"


def test_a_run_tells_how_often_it_keeps_each_bound(cli, cut):
    ending = cli(*DRAWN, cut(4), "spec.metrics.peak_torque.max=5e3")
    assert ending.code == 0  # a spec is not a failure
    table = [line.split("  ") for line in ending.err.splitlines() if " of 40  " in line]
    cells = [[cell.strip() for cell in row if cell.strip()] for row in table]
    assert [row[1] for row in cells] == ["36 of 40", "40 of 40", "36 of 40"]
    assert cells[0][2:] == ["0.1", "0.0279 to 0.237"]
    late = r"largest torque at most 5000 N m, set after the result was known \(\S+; before: none\)"
    assert re.fullmatch(late, cells[1][0])  # the run was stored without
    assert cells[2][0] == "all of them"


def test_a_run_tells_of_a_metric_that_it_lacks(cli):
    goal = ("robot=macro", "plant=rk4", "trajectory=goal", "duration=0.05")
    ending = cli(*goal, "spec.metrics.max_tracking_error.max=1", "spec.metrics.peak_torque.max=1e6")
    assert ending.code == 0
    assert "spec: the run has no max_tracking_error (did you mean cross_track_error?)" in ending.err
    checked = cli("check", ending.folder)
    assert checked.code == 2
    assert "the run has no max_tracking_error" in checked.err


@pytest.mark.parametrize(
    ("failing", "code", "said"),
    [(0, 0, "good: 1 bound, kept in every repetition"), (1, 1, "broken: 1 of 1 bound")],
)
def test_without_a_probability_no_repetition_may_fail(cli, cut, failing, code, said):
    ending = cli("check", cli(*DRAWN, cut(failing)).folder)
    assert (ending.code, ending.out.splitlines()[-1], ending.err) == (code, said, "")


@pytest.mark.parametrize(
    ("failing", "at_most", "code", "said"),
    [
        (0, "0.1", 0, "good"),
        (0, "1e-3", 1, "too few repetitions to tell: some 3650 more would do if none failed"),
        (20, "0.1", 1, "broken"),
        (4, "0.1", 1, "too few repetitions to tell: the share is at the limit itself"),
        (4, "0.2", 1, "too few repetitions to tell: some "),
    ],
)
def test_the_interval_decides_on_a_probability(cli, cut, failing, at_most, code, said):
    ending = cli("check", cli(*DRAWN, cut(failing)).folder, "--max-failure-probability", at_most)
    row = ending.out.splitlines()[1]
    assert ending.code == code
    assert said in row
    if said == "good":
        assert row.endswith("good")


@pytest.mark.usefixtures("cut")
def test_a_broken_bound_is_told_with_its_reason(cli):
    ending = cli(*DRAWN, "spec.metrics.peak_torque={max: 1, reason: the gear of joint 2}")
    assert cli("check", ending.folder).out.splitlines()[1].endswith("broken (the gear of joint 2)")


@pytest.mark.usefixtures("cut")
def test_a_reference_that_is_given_counts_and_not_the_spec(cli, tmp_path):
    path = tmp_path / "baseline.yaml"
    path.write_text("schema: 1\nmetrics:\n  peak_torque: {min: 0.0, reason: torques have no sign here}\n")
    run = cli(*DRAWN, "spec.metrics.peak_torque.max=1").folder
    assert cli("check", run, "--baseline", path).code == 0
    assert cli("check", run).code == 1


@pytest.mark.parametrize("value", ["0", "1", "often", "nan"])
def test_a_probability_lies_between_0_and_1(cli, copy_run, value):
    ending = cli("check", copy_run("rk4"), "--max-failure-probability", value)
    assert ending.code == 2
    assert (
        f"--max-failure-probability: not a probability ('{value}'). Allowed: a number above 0 and below 1."
        in ending.err
    )


def test_a_probability_needs_a_spec(cli, copy_run):
    ending = cli("check", copy_run("rk4"), "--max-failure-probability", "0.1")
    assert ending.code == 2
    assert "--max-failure-probability needs a run with a spec" in ending.err


def test_a_sweep_is_checked_cell_by_cell(cli, cut):
    swept = cli("-m", *DRAWN, "noise.position=0,1e-3", cut(4), "hydra.sweeper.workers=0")
    assert "runner: 1 of 2 cells keep the spec in every repetition." in swept.err
    ending = cli("check", swept.folder)
    assert ending.code == 1
    _, good, broken, last = ending.out.splitlines()
    assert good.split()[0] == "noise.position=0"
    assert (good.split()[-1], broken.split()[-1]) == ("good", "broken")
    assert last == "broken: 1 of 2 bounds of 2 runs"
    # The same cells, cached, are judged by the spec of the line that asks.
    again = cli("-m", *DRAWN, "noise.position=0,1e-3", f"{BOUND}=1", "hydra.sweeper.workers=0")
    assert again.folder == swept.folder
    for before in ("", "none, then "):  # one cell was stored without
        assert re.search(rf"result was known \(\S+; before: {before}at most \S+ mm\): 1 of 2 cells\.", again.err)
    assert cli("check", again.folder).code == 0


def test_runs_in_shards_are_judged_as_those_in_folders(cli, cut):
    line = ("-m", *DRAWN, "noise.position=0,1e-3", cut(4), "hydra.sweeper.workers=0")
    shards = cli("check", cli(*line, "sweep.trace=never", "outputs=shards").folder)
    folders = cli("check", cli(*line, "outputs=folders").folder)
    assert shards.out == folders.out
    again = cli(*line, f"{BOUND}=1", "sweep.trace=never", "outputs=shards")
    assert re.search(r"set after the result was known \(\S+; before: at most .*\): 2 of 2 cells\.", again.err)
    assert shards.out.splitlines()[-1] == "broken: 1 of 2 bounds of 2 runs"


SHORT = ("-m", "robot=macro", "plant=rk4", "duration=0.3", "hydra.sweeper.workers=0")


def test_without_draws_one_repetition_tells_for_sure(cli):
    swept = cli(*SHORT, "noise=none", "repetitions=3", "seed=1,2", "spec.metrics.peak_torque.max=1e5")
    ending = cli("check", swept.folder, "--max-failure-probability", "1e-6")
    assert ending.code == 0
    assert ending.out.count("exact: nothing is drawn  good") == 2


def test_a_metric_that_no_repetition_defines_breaks_its_bound_everywhere(cli):
    bounds = ("spec.metrics.steady_state_error.max=1", "spec.metrics.peak_torque.max=1e5")
    swept = cli(*SHORT, "noise=thesis", "repetitions=2", "seed=1,2", *bounds)
    assert "0 of 2 cells keep the spec" in swept.err
    assert "broken: 2 of 4 bounds" in cli("check", swept.folder).out
    text = (cli("report", swept.folder).folder / "report.html").read_text()
    assert "has the metric of the bound" not in text
    assert "4 of 4 failed, 1 (0.398 to 1)" in text  # of both seeds


def test_a_metric_that_was_never_measured_is_the_reason_of_a_broken_bound(cli):
    ending = cli("robot=macro", "plant=rk4", "trajectory=goal", "duration=0.05", "noise=thesis", "repetitions=2",
                 "spec.metrics.steady_state_error.max=5mm", "spec.metrics.peak_torque.max=1e6")  # fmt: skip
    said = "steady-state error at most 5 mm: no value in 2 of 2 repetitions  0 of 2"
    assert said in ending.err
    assert ending.err.count("no value in") == 1
    rows = cli("check", ending.folder).out.splitlines()
    assert rows[1].endswith("broken: no value in 2 of 2 repetitions")
    assert rows[2].endswith("good")
    (table,) = [each for each in outline.blocks(run_document(open_run(ending.folder))) if "Clopper" in caption(each)]
    assert table.rows[0][0] == "steady-state error at most 5 mm: no value in 2 of 2 repetitions"


def caption(block):
    return block.caption if isinstance(block, Table) else ""
