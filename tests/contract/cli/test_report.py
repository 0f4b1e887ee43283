"""`runner report`: what each kind of folder gives, and what is refused."""

import json
import re
import shutil

import pytest
from fixtures.stored import SHORT


@pytest.fixture
def stored(copy_run):
    return copy_run("goal")


@pytest.fixture
def sweep(copy_sweep):
    return copy_sweep("goal", "other seed")


@pytest.mark.parametrize(
    ("flags", "files"),
    [
        ([], ["report.html", "report.pdf"]),
        (["--format", "html"], ["report.html"]),
        (["--format", "pdf"], ["report.pdf"]),
        (["--format", "pdf,html"], ["report.html", "report.pdf"]),
    ],
)
def test_a_run_is_reported_in_the_formats_chosen(cli, stored, flags, files):
    ending = cli("report", stored, *flags)
    assert ending.code == 0
    assert ending.folder.parent == stored.parent.parent / "reports"
    assert sorted(path.name for path in ending.folder.iterdir()) == files


def test_a_report_is_written_where_it_is_asked_for(cli, sweep, tmp_path):
    ending = cli("report", sweep, "--format", "html", "-o", tmp_path / "mine" / "page")
    assert ending.folder == tmp_path / "mine" / "page"
    assert "../../outputs/runs" in (ending.folder / "report.html").read_text()


def test_a_report_can_be_made_from_a_copied_run(cli, stored, tmp_path):
    here = cli("report", stored, "--format", "html").folder.joinpath("report.html").read_bytes()
    copy = tmp_path / "elsewhere" / "runs" / stored.name
    shutil.copytree(stored, copy)
    shutil.rmtree(tmp_path / "outputs")
    ending = cli("report", copy, "--format", "html")
    assert ending.code == 0
    assert ending.folder.joinpath("report.html").read_bytes() == here


def test_a_sweep_has_a_report_of_its_own_with_links_to_its_runs(cli, sweep):
    ending = cli("report", sweep, "--format", "html")
    page = ending.folder.joinpath("report.html").read_text()
    assert "Sweep over seeds" in page
    assert "repetitions in each: 1" in page
    links = re.findall(r'"folders": (\[.*?\])', page)
    assert [(ending.folder / link / "metrics.json").exists() for link in json.loads(links[0])] == [True, True]
    assert ending.folder != cli("report", sweep, "--format", "html", "--metrics", "peak_torque").folder


def test_several_runs_are_reported_run_by_run(cli, copy_run, stored):
    other = copy_run("other seed")
    page = cli("report", other, stored, "--format", "html").folder.joinpath("report.html").read_text()
    assert "Side by side" in page
    assert "A and B differ in no value." in page


def test_several_sweeps_are_compared(cli):
    folders = [
        cli("-m", "hydra.sweeper.workers=0", *SHORT, "gravity=9.81,9.7", f"torque_limits.max={limit}").folder
        for limit in (30, 31)
    ]
    ending = cli("report", *folders, "--format", "html")
    page = ending.folder.joinpath("report.html").read_text()
    assert "Which torque_limits.max: 30 (A) or 31 (B)?" in page
    assert "A and B differ only in torque_limits.max: 30 against 31." in page
    chosen = cli("report", *folders, "--format", "html", "--metrics", "energy").folder
    assert chosen != ending.folder
    assert "rms torque" not in chosen.joinpath("report.html").read_text()
    refused = cli("report", *folders, "--metrics", "enrgy")
    assert (refused.code, refused.out) == (2, "")
    assert "metrics: unknown metric 'enrgy'" in refused.err


def test_runs_and_sweeps_have_no_report_together(cli, sweep, stored):
    ending = cli("report", sweep, stored, "--format", "html")
    assert (ending.code, ending.out) == (2, "")
    assert (
        ending.err == "runner: these results have no common report. Allowed: only runs, only sweeps, or one folder.\n"
    )


def test_a_metric_is_asked_for_where_a_sweep_has_it(cli, sweep, stored):
    ending = cli("report", sweep, "--metrics", "peak_torq")
    assert ending.code == 2
    assert "metrics: unknown metric 'peak_torq'" in ending.err
    assert f"--metrics: {stored} is not a sweep." in cli("report", stored, "--metrics", "peak_torque").err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "the following arguments are required: DIR. Usage: runner report"),
        (("nowhere",), "nowhere: no such folder"),
        (
            (".",),
            ".: it is not the folder of a stored result. Allowed: the folder of a run (`runner OVERRIDES` prints it)",
        ),
    ],
)
def test_bad_input_is_told(cli, arguments, message):
    ending = cli("report", *arguments)
    assert ending.code == 2
    assert message in ending.err
    assert ending.out == ""
