import pytest

from runner.reporting.run_report import run_document
from runner.reporting.thesis.plan import Job


@pytest.fixture
def small_work(monkeypatch):
    """A thesis of three short runs, one of which fails."""
    jobs = {
        "goal": Job(("robot=macro", "duration=0.1"), 10),
        "quintic": Job(("robot=mini", "trajectory=quintic", "duration=0.01"), 10),
        "singular": Job(("experiment=thesis/singular",), 400),
    }
    monkeypatch.setattr("runner.reporting.thesis.plan.plan", lambda: jobs)
    monkeypatch.setattr(
        "runner.reporting.thesis.report.thesis_document", lambda runs: run_document(list(runs.values()))
    )


def test_an_unknown_work_names_the_nearest(cli, tmp_path):
    ending = cli("reproduce", "thesys")
    assert ending.code == 2
    assert ending.err == "runner: no work 'thesys' (did you mean thesis?); works: thesis, all\n"
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

    second = cli("reproduce", "all")
    assert (second.code, second.folder) == (0, first.folder)
    assert [path.stat().st_mtime_ns for path in records] == written
    assert second.folder.joinpath("report.html").read_bytes() == report
    assert second.folder.joinpath("report.pdf").read_bytes().startswith(b"%PDF")


def test_outputs_that_cannot_be_written_are_told_before_anything_is_simulated(cli, small_work, tmp_path):
    (tmp_path / "file").write_text("in the way")
    ending = cli("reproduce", "--outputs", "file")
    assert ending.code == 2
    assert ending.err.startswith("runner: cannot write file/runs")
