"""Commands at work: their locks end with their processes, those of other machines with their signs."""

import os
import subprocess
import sys
import time

import pytest
from support.patience import PATIENCE, wait_until

from runner.base.errors import RunnerError, StoreError
from runner.sweeps.at_work import at_work, commands_at_work, commands_in

HOLDS = (
    "import sys; from pathlib import Path; from runner.sweeps.at_work import at_work; \n"
    "with at_work(Path(sys.argv[1]), exclusive=True): print('held', flush=True); sys.stdin.read()"
)


def test_a_killed_process_leaves_no_lock(tmp_path, monkeypatch):
    monkeypatch.setattr("runner.sweeps.at_work._PATIENCE", 0.1)
    holder = subprocess.Popen([sys.executable, "-c", HOLDS, tmp_path], stdin=-1, stdout=-1)
    assert holder.stdout.readline() == b"held\n"
    assert [command.job for command in commands_at_work(tmp_path)] == [f"process {holder.pid}"]
    with (
        pytest.raises(RunnerError, match=f"another command is at work on .*process {holder.pid}"),
        at_work(tmp_path, exclusive=True),
    ):
        pass
    with at_work(tmp_path):
        assert len(commands_at_work(tmp_path)) == 2
    holder.kill()
    holder.communicate(timeout=PATIENCE)
    assert commands_at_work(tmp_path) == []
    with at_work(tmp_path, exclusive=True):
        assert len(commands_at_work(tmp_path)) == 1
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize(
    ("variables", "job"),
    [
        ({}, "process {}"),
        ({"SLURM_JOB_ID": "16"}, "job 16"),
        ({"SLURM_JOB_ID": "19", "SLURM_ARRAY_JOB_ID": "16", "SLURM_ARRAY_TASK_ID": "3"}, "job 16_3"),
    ],
)
def test_commands_of_an_outputs_folder_have_names_and_jobs(tmp_path, monkeypatch, variables, job):
    for name in ("SLURM_JOB_ID", "SLURM_ARRAY_JOB_ID", "SLURM_ARRAY_TASK_ID"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    with at_work(tmp_path / "sweeps" / "a") as one, at_work(tmp_path / "sweeps" / "a") as two:
        with at_work(tmp_path / "tunings" / "b", exclusive=True):
            found = commands_in(tmp_path)
            assert {command.name for command in found} == {one, two, "exclusive"}
            assert {command.job for command in found} == {job.format(os.getpid())}
        assert len(commands_in(tmp_path)) == 2
    assert commands_in(tmp_path) == []


def test_what_another_machine_left_is_removed_when_it_is_old(tmp_path, monkeypatch):
    monkeypatch.setattr("runner.sweeps.at_work._PATIENCE", 0.1)
    sign = tmp_path / "at_work-exclusive"
    sign.write_text("n1\njob 16\n")
    with pytest.raises(RunnerError, match="n1, job 16, last sign 1 s ago"), at_work(tmp_path, exclusive=True):
        pass
    os.utime(sign, (time.time() - 130, time.time() - 130))
    with at_work(tmp_path, exclusive=True):
        assert sign.read_text() != "n1\njob 16\n"


def test_signs_are_given_while_the_command_works(tmp_path, monkeypatch):
    monkeypatch.setattr("runner.sweeps.at_work._EVERY", 0.01)
    with at_work(tmp_path):
        (path,) = tmp_path.iterdir()
        os.utime(path, (0.0, 0.0))
        wait_until(lambda: path.stat().st_mtime > 0.0)
        assert commands_at_work(tmp_path)[0].age < 60.0


@pytest.mark.parametrize("content", [b"", b"n1", b"\xff\n\x1b[31m\n"])
def test_a_file_that_says_little_is_a_command_without_a_name(tmp_path, content):
    (tmp_path / "at_work-a").write_bytes(content)
    (command,) = commands_at_work(tmp_path)
    assert "last sign 1 s ago" in str(command)
    assert "\x1b" not in str(command)


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="cannot write"), at_work(tmp_path / "file" / "folder"):
        pass
