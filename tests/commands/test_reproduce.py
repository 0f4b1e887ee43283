import csv

import pytest

from runner.audit.audit import audit
from runner.audit.entry import parts
from runner.audit.verdict import VERDICTS
from runner.commands.reproduce import WORKS
from runner.reporting.job import Job
from runner.reporting.run_report import run_document


@pytest.fixture
def small_work(monkeypatch):
    """Works of three short runs, one of which fails."""
    jobs = {
        "goal": Job(("robot=macro", "duration=0.1"), 10),
        "quintic": Job(("robot=mini", "trajectory=quintic", "duration=0.01"), 10),
        "singular": Job(("experiment=thesis/singular",), 400),
    }
    for work in ("thesis", "xarm7"):
        monkeypatch.setattr(f"runner.reporting.{work}.plan.plan", lambda: jobs)
        monkeypatch.setattr(
            f"runner.reporting.{work}.report.{work}_document", lambda runs: run_document(list(runs.values()))
        )


def test_an_unknown_work_names_the_nearest(cli, tmp_path):
    ending = cli("reproduce", "thesys")
    assert ending.code == 2
    assert ending.err == "runner: no work 'thesys' (did you mean thesis?); works: thesis, xarm7, meca500, audit, all\n"
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_flag_is_bad_input(cli):
    ending = cli("reproduce", "--fast")
    assert ending.code == 2
    assert "unrecognized arguments: --fast; usage: runner reproduce" in ending.err


def test_a_second_time_nothing_is_simulated(cli, small_work, tmp_path):
    first = cli("reproduce", "thesis")
    assert first.code == 0
    assert first.folder == tmp_path / "outputs" / "reports" / "thesis"
    assert sorted(path.name for path in first.folder.iterdir()) == ["report.html", "report.pdf"]
    records = sorted((tmp_path / "outputs" / "runs").glob("*/metrics.json"))
    assert len(records) == 3
    written = [path.stat().st_mtime_ns for path in records]
    report = first.folder.joinpath("report.html").read_bytes()

    second = cli("reproduce", "thesis")
    assert (second.code, second.folder) == (0, first.folder)
    assert [path.stat().st_mtime_ns for path in records] == written
    assert first.folder.joinpath("report.html").read_bytes() == report
    assert first.folder.joinpath("report.pdf").read_bytes().startswith(b"%PDF")


def test_the_audit_is_a_report_and_a_table(cli, monkeypatch, tmp_path):
    monkeypatch.setattr("runner.audit.audit.audit_all", lambda: {"xarm7": audit("xarm7", samples=20)})
    ending = cli("reproduce", "audit")
    assert (ending.code, ending.folder) == (0, tmp_path / "outputs" / "reports" / "audit")
    names = sorted(path.name for path in ending.folder.iterdir())
    assert names == ["equations.csv", "report.html", "report.pdf"]
    table = list(csv.DictReader(ending.folder.joinpath("equations.csv").read_text(encoding="utf-8").splitlines()))
    assert len(table) == sum(len(part.entries) for part in parts("xarm7"))
    assert {row["verdict"] for row in table} <= set(VERDICTS)


def test_all_reproduces_every_work(cli, small_work, monkeypatch, tmp_path):
    monkeypatch.setattr("runner.commands.reproduce._WORKS", {name: lambda *_: None for name in WORKS})
    assert cli("reproduce").out.split() == [f"outputs/reports/{name}" for name in WORKS]


def test_outputs_that_cannot_be_written_are_told_before_anything_is_simulated(cli, small_work, tmp_path):
    (tmp_path / "file").write_text("in the way")
    ending = cli("reproduce", "thesis", "--outputs", "file")
    assert ending.code == 2
    assert ending.err.startswith("runner: cannot write file/runs")
