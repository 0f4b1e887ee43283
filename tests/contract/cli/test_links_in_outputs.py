"""Links in a stranger's outputs folder: nothing is removed, written or cleaned up through them."""

import os
import shutil
from pathlib import Path

import pytest
from support.engines import ASKED

from runner.base.atomic import remove_leftovers
from runner.base.errors import StoreError
from runner.store.kinds import FILES, KINDS, prepare

TASK = ("robot=macro", ASKED, "duration=0.05", "hydra.sweeper.workers=0")
OLD = 0.0


@pytest.fixture
def victim(tmp_path):
    """A folder of another user, with projects that look like a run and a report."""
    folder = tmp_path / "victim"
    for project, name in (("project1", "config.yaml"), ("project2", "report.html")):
        (folder / project).mkdir(parents=True)
        (folder / project / name).write_text("dear")
        (folder / project / "data.csv").write_text("dear")
    for path in folder.rglob("*"):
        os.utime(path, (OLD, OLD))
    return folder


def contents(folder):
    return {path: path.read_text() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize(("kind", "link"), [("run", "folder"), ("report", "folder"), ("run", "entry")])
def test_nothing_is_deleted_through_a_link(cli, victim, tmp_path, kind, link):
    before = contents(victim)
    stranger = tmp_path / "stranger"
    stranger.mkdir()
    place = stranger / KINDS[kind].folder
    if link == "folder":
        place.symlink_to(victim)
    else:
        place.mkdir()
        place = place / "abc"
        place.symlink_to(victim / "project1")
    ending = cli("results", stranger, "--delete", "2025-01-01", "--yes")
    assert (ending.code, ending.out) == (0, "")
    assert f"runner: {place}: it is a link, and nothing that it leads to is removed" in ending.err
    assert "removed 0 of 1 results" in ending.err
    assert contents(victim) == before


def test_what_is_no_link_is_deleted_beside_one(cli, victim, tmp_path):
    run = cli(*TASK[:3], "-o", "stranger").folder
    (run.parent / "abc").symlink_to(victim / "project1")
    ending = cli("results", "stranger", "--delete", "0d", "--yes")
    assert ending.out.splitlines() == [str(run.relative_to(tmp_path))]
    assert not run.exists()
    assert (victim / "project1" / "data.csv").exists()


def test_no_report_is_written_through_a_link(cli, victim, copy_run, tmp_path):
    folder = copy_run("goal")
    report = cli("report", folder, "--format", "html").folder
    shutil.rmtree(report)
    report.symlink_to(victim / "project2")
    before = contents(victim)
    for words in (("report", folder), ("figures", folder)):
        ending = cli(*words)
        assert (ending.code, ending.out) == (2, "")
        assert (
            f"{report.relative_to(tmp_path)}: it is a link, through which nothing is written. Remove it" in ending.err
        )
    report.unlink()
    report.parent.rmdir()
    report.parent.symlink_to(victim)
    assert "reports: it is a link" in cli("report", folder).err
    assert contents(victim) == before
    assert cli("report", folder, "--format", "html", "-o", "mine").code == 0
    report.parent.unlink()
    assert cli("report", folder, "--format", "html").code == 0


def test_no_table_is_written_through_a_link(cli, victim, copy_sweep):
    folder = copy_sweep("goal", "other seed")
    shutil.copytree(folder, victim / "sweep")
    before = contents(victim)
    shutil.rmtree(folder)
    folder.symlink_to(victim / "sweep")
    assert "it is a link" in cli("table", folder).err
    assert contents(victim) == before


@pytest.mark.parametrize("name", sorted({*(kind.folder for kind in KINDS.values()), *FILES}))
def test_no_result_is_made_where_a_folder_is_a_link(victim, tmp_path, name):
    (tmp_path / "stranger").mkdir()
    (tmp_path / "stranger" / name).symlink_to(victim)
    with pytest.raises(StoreError, match=f"stranger/{name}: it is a link, through which nothing is written"):
        prepare(tmp_path / "stranger")


@pytest.mark.parametrize("place", ["", "logs"])
def test_no_sweep_is_made_through_a_link(cli, victim, place):
    sweep = cli("-m", *TASK, "seed=0,1", "-o", "stranger").folder
    linked = sweep / place
    shutil.rmtree(linked, ignore_errors=True)
    linked.symlink_to(victim)
    before = contents(victim)
    ending = cli("-m", *TASK, "seed=0,1", "-o", "stranger")
    assert (ending.code, ending.out) == (2, "")
    assert "it is a link" in ending.err
    assert contents(victim) == before


def test_no_run_is_made_and_no_result_is_noted_through_a_link(cli, victim, tmp_path):
    folder = cli(*TASK[:3], "-o", "stranger").folder
    shutil.rmtree(folder)
    folder.symlink_to(victim / "project1")
    before = contents(victim)
    assert "it is a link" in cli(*TASK[:3], "-o", "stranger").err
    folder.unlink()
    shutil.rmtree(tmp_path / "stranger/newest")
    (tmp_path / "stranger/newest").symlink_to(victim)
    ending = cli(*TASK[:3], "-o", "stranger")
    assert ending.code == 0
    assert "newest: it is a link" in ending.err
    assert contents(victim) == before


def test_leftovers_behind_a_link_stay(victim, tmp_path):
    left = victim / ".a.tmp"
    left.write_text("dear")
    os.utime(left, (OLD, OLD))
    (tmp_path / "shards").symlink_to(victim)
    remove_leftovers(tmp_path / "shards")
    assert left.exists()
    remove_leftovers(victim)
    assert not left.exists()


def test_the_outputs_folder_itself_may_be_a_link(cli, tmp_path):
    (tmp_path / "disk").mkdir()
    Path("mine").symlink_to(tmp_path / "disk")
    assert cli("-m", *TASK, "seed=0,1", "-o", "mine").code == 0
    assert cli("report", "mine/latest", "--format", "html").code == 0
    assert "removed 4 of 4 results" in cli("results", "mine", "--delete", "0d", "--yes").err
