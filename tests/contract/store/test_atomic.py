"""Atomic writing: leftovers of killed writers against files of living ones."""

import os
import socket
import subprocess
import sys

import pytest

from runner.base.atomic import remove_leftovers, write_atomically

DIES = (
    "import os, sys; from pathlib import Path; import runner.base.atomic as a; os.fsync = lambda _: os._exit(9); "
    "a.write_atomically(Path(sys.argv[1]), b'half')"
)


def test_what_a_killed_writer_leaves_is_removed(tmp_path):
    path = tmp_path / "file"
    write_atomically(path, b"whole")
    assert subprocess.run([sys.executable, "-c", DIES, path]).returncode == 9
    assert len([*tmp_path.iterdir()]) == 2
    remove_leftovers(tmp_path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["file"]
    assert path.read_bytes() == b"whole"


@pytest.mark.parametrize(
    ("host", "process", "age", "stays"),
    [
        (socket.gethostname(), os.getpid(), 0.0, True),
        (socket.gethostname(), os.getpid(), 90.0, False),
        ("elsewhere.net", 1, 0.0, True),
        ("elsewhere.net", 1, 90.0, False),
    ],
    ids=["ours, new", "ours, old", "another machine's, new", "another machine's, old"],  # no process numbers in names
)
def test_files_of_living_writers_stay_for_a_minute(tmp_path, host, process, age, stays):
    path = tmp_path / f".trace.parquet.{host}.{process}.tmp"
    path.touch()
    now = path.stat().st_mtime
    os.utime(path, (now - age, now - age))
    remove_leftovers(tmp_path)
    assert path.exists() == stays


def test_a_writer_that_ended_and_was_not_waited_for_is_gone(tmp_path):
    """As a killed command's processes are, until the system has collected them."""
    with subprocess.Popen([sys.executable, "-c", ""], stdout=subprocess.PIPE) as process:
        assert process.stdout.read() == b""  # it has closed its files, and no process has waited for it
        left = tmp_path / f".metrics.json.{socket.gethostname()}.{process.pid}.tmp"
        left.write_bytes(b"{")
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)  # ended, and not collected
        remove_leftovers(tmp_path)
        assert not left.exists()


def test_a_folder_that_is_not_there_has_no_leftovers(tmp_path):
    remove_leftovers(tmp_path / "nowhere")
