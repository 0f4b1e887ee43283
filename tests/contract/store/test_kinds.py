"""The newest result: noted in order by many processes, and never an older one."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from runner.base.errors import RunnerError
from runner.store.kinds import find_folder, kind_of, note

_FILES = {
    "runs": "metrics.json", "sweeps": "sweep.json", "tunings": "tuning.json", "calibrations": "result.json",
    "reports": "report.html",
}  # fmt: skip


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def made(kind, name, outputs="outputs"):
    folder = Path(outputs, kind, name)
    folder.mkdir(parents=True)
    (folder / _FILES[kind]).touch()
    note(folder)
    return folder


def test_latest_is_what_was_made_or_found_last():
    first, second = made("runs", "b"), made("runs", "a")
    assert find_folder("latest", ["run"]) == second
    note(first)
    assert find_folder("latest", ["run"]) == first


def test_of_several_kinds_latest_is_the_last_of_all():
    run, sweep, tuning = made("runs", "r"), made("sweeps", "s"), made("tunings", "t")
    assert find_folder("latest", ["run", "sweep", "tuning"]) == tuning
    assert find_folder("latest", ["run", "sweep"]) == sweep
    note(run)
    assert find_folder("latest", ["sweep", "run"]) == run


def test_the_order_stays_where_the_clock_is_set_back(monkeypatch):
    made("sweeps", "s")
    monkeypatch.setattr("runner.store.kinds.time.time_ns", lambda: 0)
    assert find_folder("latest", ["run", "sweep"]) != (run := made("runs", "r"))
    assert find_folder("latest", ["run", "sweep"]) == run


def test_each_outputs_folder_has_its_own_latest():
    made("runs", "here")
    there = made("runs", "there", "elsewhere")
    assert find_folder("elsewhere/latest", ["run"]) == there


def test_a_copied_outputs_folder_keeps_its_latest():
    made("runs", "r")
    shutil.copytree("outputs", "copy")
    assert find_folder(Path("copy/latest"), ["run"]) == Path("copy/runs/r")


def test_a_folder_of_that_name_is_that_folder():
    made("runs", "r")
    Path("latest").mkdir()
    Path("latest/metrics.json").touch()
    assert find_folder("latest", ["run"]) == Path("latest")


def test_a_copy_that_lies_elsewhere_is_not_noted(tmp_path):
    Path("mine").mkdir()
    note(Path("mine"))
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]


def test_processes_that_note_at_once_spoil_nothing():
    folders = [made(kind, str(number)) for number in range(10) for kind in ("runs", "sweeps")]
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(note, folders))
    assert find_folder("latest", ["run"]).parent.name == "runs"
    assert find_folder("latest", ["sweep"]).parent.name == "sweeps"
    assert not list(Path("outputs").rglob("*.tmp"))


@pytest.mark.parametrize(
    ("kinds", "needed"),
    [(["run"], "no run was made in outputs yet"), (["run", "sweep"], "no run or sweep was made in outputs yet")],
)
def test_nothing_yet_is_one_clear_line(kinds, needed):
    with pytest.raises(RunnerError, match=needed) as caught:
        find_folder("latest", kinds)
    assert "\n" not in str(caught.value)


def test_what_is_gone_is_not_replaced_by_an_older_one():
    made("runs", "a")
    shutil.rmtree(made("runs", "b"))
    with pytest.raises(RunnerError, match=r"outputs/runs/b no longer exists"):
        find_folder("latest", ["run"])


@pytest.mark.parametrize("content", ["", "[]", '{"name": "../../etc", "order": 1}', '{"name": "r"}', "\xff"])
def test_a_damaged_note_is_as_none(content):
    made("runs", "r")
    Path("outputs/newest/runs.json").write_text(content, encoding="latin-1")
    with pytest.raises(RunnerError, match="no run was made in outputs yet"):
        find_folder("latest", ["run"])


def test_an_outputs_folder_that_cannot_be_written_is_told(capsys):
    made("runs", "r")
    shutil.rmtree("outputs/newest")
    Path("outputs/newest").touch()
    note(Path("outputs/runs/r"))
    assert "`latest` will not mean outputs/runs/r" in capsys.readouterr().err


@pytest.mark.parametrize(("kind", "named"), [("runs", "run"), ("tunings", "tuning"), ("calibrations", "calibration")])
def test_a_folder_of_another_kind_is_refused_in_a_line(kind, named):
    folder = made(kind, "x")
    assert kind_of(folder) == named
    with pytest.raises(RunnerError, match=f"{folder}: it is the folder of a {named}. Allowed: the folder of a sweep"):
        find_folder(str(folder), ["sweep"])


def test_a_folder_of_nothing_and_no_folder_are_refused_in_a_line():
    with pytest.raises(
        RunnerError,
        match=r"^\.: it is not the folder of a stored result\. Allowed: the folder of a run \(`runner OVERRIDES`",
    ):
        find_folder(".", ["run"])
    with pytest.raises(RunnerError, match=r"^nowhere: no such folder. Allowed: the folder of a run"):
        find_folder("nowhere", ["run"])
