"""`runner reproduce`: new and cached runs, reports, conclusions, and the lines of `--check`."""

import csv
import json

import pytest

from runner.papers.audit.audit import audit
from runner.papers.audit.verdict import VERDICTS
from runner.papers.commands import reproduce
from runner.papers.study.execute import make_all
from runner.papers.study.measured import Measured, finding
from runner.papers.study.study import load_study
from runner.reporting.document import Document, Section
from runner.sweeps import job as workers
from runner.sweeps import work

FILES = {
    "study.yaml": "title: T\nsource: S\nabstract: A\nchapters: [one.md, two.md]\n",
    "runs.yaml": """\
grids:
  goal: {with: [robot=macro, duration=0.1]}
  quintic: {with: [robot=mini, trajectory=quintic, duration=0.01]}
  singular: {with: [experiment=thesis/singular]}
""",
    "one.md": '# One\n\n{{ failures("singular") }}\n\n{{ table("Goal.", "goal", column("moved", "peak_torque")) }}\n',
    "two.md": '# Two\n\n{{ table("Quintic.", "quintic", column("moved", "peak_torque")) }}\n',
}


@pytest.fixture
def small_study(tmp_path):
    """A study of three short runs in the folder `small`; one run fails."""
    folder = tmp_path / "small"
    folder.mkdir()
    for name, text in FILES.items():
        (folder / name).write_text(text)
    return folder


def test_an_unknown_study_names_the_nearest(cli, tmp_path):
    ending = cli("reproduce", "thesys")
    assert ending.code == 2
    studies = "benchmark, engines, meca500, precision, thesis, thesis_beyond, xarm7"
    studies += ", audit, all, or a folder with a study.yaml"
    assert ending.err == f"runner: no study 'thesys' (did you mean thesis?); studies: {studies}\n"
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_flag_is_bad_input(cli):
    ending = cli("reproduce", "--fast")
    assert ending.code == 2
    assert "unrecognized arguments: --fast. Usage: runner reproduce" in ending.err


HERE = "hydra.sweeper.workers=0"


def test_a_second_time_nothing_is_simulated(cli, small_study, tmp_path):
    first = cli("reproduce", "small", HERE)
    assert first.code == 0
    assert first.folder == tmp_path / "outputs" / "reports" / "small"
    assert sorted(path.name for path in first.folder.iterdir()) == ["conclusions.json", "report.html", "report.pdf"]
    records = sorted((tmp_path / "outputs" / "runs").glob("*/metrics.json"))
    assert len(records) == 3
    written = [path.stat().st_mtime_ns for path in records]
    report = first.folder.joinpath("report.html").read_bytes()

    second = cli("reproduce", "small")
    assert (second.code, second.folder) == (0, first.folder)
    assert [path.stat().st_mtime_ns for path in records] == written
    assert first.folder.joinpath("report.html").read_bytes() == report
    assert first.folder.joinpath("report.pdf").read_bytes().startswith(b"%PDF")


def test_a_run_that_was_cut_short_is_an_error_and_the_report_says_what_is_missing(cli, small_study, monkeypatch):
    simulate = workers.simulate_run

    def breaks(config, threads):
        if config.composed.choices["robot"] == "mini":
            raise RuntimeError("the machine broke")
        return simulate(config, threads)

    monkeypatch.setattr(workers, "simulate_run", breaks)
    monkeypatch.setattr(work, "make_together", lambda *_: (set(), False))
    ending = cli("reproduce", "small", HERE)
    assert ending.code == 1
    assert "runner: small: quintic is missing in the report: cut short: RuntimeError: the machine broke" in ending.err
    page = (ending.folder / "report.html").read_text()
    assert "Not made, and so missing in this report" in page
    assert "This part needs what was not made: quintic: cut short: RuntimeError: the machine broke" in page
    assert "1 of 1 runs failed" in page  # the one that diverged is a result like any other
    monkeypatch.setattr(workers, "simulate_run", simulate)
    assert cli("reproduce", "small", HERE).code == 0


def test_only_how_runs_are_made_can_be_set(cli, small_study):
    for text in ("seed=1", "sweep.trace=never", "hydra.searchpath=[]"):
        ending = cli("reproduce", "small", text)
        assert ending.code == 2
        assert f"reproduce: the study decides what it simulates ({text}). Allowed: hydra.sweeper.*, " in ending.err
    ending = cli("reproduce", "small", HERE, "limits.cpu_hours=1e-9")
    assert ending.code == 2
    assert "limits.cpu_hours: 3 runs would take about" in ending.err


def test_calibrations_are_made_by_the_same_engine(small_study, tmp_path):
    (small_study / "runs.yaml").write_text(
        "grids: {goal: {with: [robot=macro, duration=0.1]}}\n"
        "calibrations:\n  tool: {with: [calibration=tool_direction, repetitions=2]}\n"
        "  none: {with: [calibration.poses=3]}\n"
    )
    study = load_study(str(small_study))
    runs, found = make_all(study, tmp_path, (HERE,))
    assert (list(runs), list(found), runs.missing, found.missing) == (["goal"], ["tool", "none"], {}, {})
    noted = tmp_path / "newest"
    written = {
        path: path.stat().st_mtime_ns
        for path in tmp_path.rglob("*.json")
        if path.parent.parent.name != "sweeps" and path.parent != noted
    }
    path = found["tool"].folder / "robot.urdf"
    path.write_text(path.read_text().replace("1", "2", 1))
    make_all(study, tmp_path, (HERE,))
    again = [path for path, time in written.items() if path.stat().st_mtime_ns != time]
    assert again == [found["tool"].folder / "result.json"]


def test_the_audit_is_a_report_and_a_table(cli, monkeypatch, tmp_path):
    checked = audit("meca500", samples=20)[:10]
    monkeypatch.setattr("runner.papers.audit.audit.audit_all", lambda: {"meca500": checked})
    ending = cli("reproduce", "audit")
    assert (ending.code, ending.folder) == (0, tmp_path / "outputs" / "reports" / "audit")
    names = sorted(path.name for path in ending.folder.iterdir())
    assert names == ["conclusions.json", "equations.csv", "report.html", "report.pdf"]
    table = list(csv.DictReader(ending.folder.joinpath("equations.csv").read_text(encoding="utf-8").splitlines()))
    assert len(table) == len(checked) == 10
    assert {row["verdict"] for row in table} <= set(VERDICTS)


def test_all_reproduces_every_study_the_shortest_first(cli, monkeypatch, tmp_path):
    empty = reproduce._Reproduced(Document("", "", "", (), "2026-01-01"), {}, {})
    monkeypatch.setattr(reproduce, "_reproduce_study", lambda *_: empty)
    monkeypatch.setattr(reproduce, "_audit", lambda *_: empty)
    monkeypatch.setattr("runner.reporting.render.write_report", lambda *_: None)
    assert cli("reproduce").out.split() == [
        f"outputs/reports/{name}" for name in ("audit", "xarm7", "meca500", "thesis_beyond", "thesis")
    ]


def test_outputs_that_cannot_be_written_are_told_before_anything_is_simulated(cli, small_study, tmp_path):
    (tmp_path / "file").write_text("in the way")
    ending = cli("reproduce", "small", "--output", "file")
    assert ending.code == 2
    assert ending.err.startswith("runner: cannot write file/runs")


@pytest.fixture
def one_finding(monkeypatch):
    """Let the thesis' report be one finding that no longer holds, and one that does."""
    error = Measured("tip error", 2e-3, "m")
    section = Section("One", (finding("Small", f"It is {error}.", error < 1e-3), finding("Not zero", "-", error > 0.0)))
    made = reproduce._Reproduced(Document("The thesis", "", "", (section,), "2026-01-01"), {}, {})
    monkeypatch.setattr(reproduce, "_reproduce_study", lambda *_: made)


def test_conclusions_are_written_for_programs(cli, one_finding, tmp_path):
    ending = cli("reproduce", "thesis", "--json")
    assert (ending.code, ending.err.splitlines()[-1]) == (0, "outputs/reports/thesis")
    small, other = json.loads(ending.out)["thesis"]["findings"]
    assert (small["section"], small["title"], small["text"]) == ("1", "Small", "It is 2 mm.")
    assert (small["holds"], other["holds"]) == (False, True)
    assert small["conditions"][0]["text"] == "tip error < 1 mm"


def test_a_file_behind_json_is_rejected_with_the_redirection(cli):
    ending = cli("reproduce", "thesis", "--json", "thesis.json")
    assert (ending.code, ending.out) == (2, "")
    assert "--json takes no file (thesis.json). Write a file by `--json > thesis.json`" in ending.err


def test_jobs_are_the_processes_of_the_sweep(cli, small_study, monkeypatch):
    given = []
    monkeypatch.setattr("runner.papers.study.execute.make_all", lambda *arguments: given.append(arguments[2]) or 1 / 0)
    assert cli("reproduce", "small", "--jobs", "3", "sweep.time_limit=9").code == 3
    assert given == [["sweep.time_limit=9", "hydra.sweeper.workers=3"]]
