"""`runner example`: the files copied, and that they run."""

import os
import sys

import pytest

from runner.base.paths import examples_dir


def test_all_examples_are_copied_as_they_are(cli, tmp_path):
    ending = cli("example", "new/mine")
    assert ending.code == 0
    assert ending.folder == tmp_path / "new/mine"
    copied = {path.relative_to(ending.folder) for path in ending.folder.rglob("*") if path.is_file()}
    there = {path.relative_to(examples_dir()) for path in examples_dir().rglob("*") if path.is_file()}
    assert copied == {path for path in there if "__pycache__" not in path.parts}
    for name in copied:
        assert (ending.folder / name).read_bytes() == (examples_dir() / name).read_bytes()
    assert os.access(ending.folder / "own_robot/check.sh", os.X_OK)
    assert ending.err == f"runner: {len(copied)} files copied; new/mine/own_robot/README.md is a start\n"


def test_a_copied_example_runs(cli, monkeypatch):
    monkeypatch.setenv("RUNNER_PLUGINS", "")  # so that the plug-in is forgotten after the test
    monkeypatch.setattr(sys, "path", [*sys.path])
    folder = cli("example", "mine").folder
    parts = ("--plugin", f"controller={folder}/own_robot/gravity_pd.py", "--config-dir", f"{folder}/own_robot")
    assert cli(*parts, "robot=lamp", "controller=gravity_pd", "trajectory=goal", "duration=0.05").code == 0
    sys.modules.pop("gravity_pd")


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_what_is_there_stays(cli, tmp_path, kind):
    taken = tmp_path / "mine"
    if kind == "folder":
        taken.mkdir()
        (taken / "kept.txt").write_text("kept")
    else:
        taken.write_text("kept")
    ending = cli("example", "mine")
    assert (ending.code, ending.err) == (
        2,
        "runner: mine: this folder is not empty. Allowed: a new folder, or an empty one.\n",
    )


def test_a_folder_that_cannot_be_written_is_named(cli, tmp_path):
    (tmp_path / "file").write_text("")
    ending = cli("example", "file/mine")
    assert (ending.code, ending.out) == (2, "")
    assert ending.err.startswith("runner: file/mine: cannot be written: ")
