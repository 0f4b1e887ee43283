"""Commands as separate processes: their outputs closed, full or unread, and two of them at once."""

import json
import subprocess
import sys

import pytest
from support.patience import PATIENCE
from support.printed import without_caveats, without_results

SHORT = ("robot=macro", "duration=0.05")


def start(*arguments, cwd):
    command = [sys.executable, "-m", "runner", *arguments]
    return subprocess.Popen(command, cwd=cwd, stdout=-1, stderr=-1, text=True)


@pytest.mark.costs(2)
def test_two_processes_may_make_the_same_run_at_once(cli, tmp_path, gate):
    """One makes it whole while the other has written a part of it."""
    words = (*SHORT, "noise=thesis")
    command = gate.command("os:fsync", 2, *words)
    with subprocess.Popen(command, cwd=tmp_path, stdout=-1, stderr=-1, text=True) as process:
        gate.next_at()
        ending = cli(*words)
        gate.open()
        out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, ending.code) == (0, 0)
    told = [
        [line for line in text.splitlines() if "PyBullet is not installed" not in line] for text in (err, ending.err)
    ]
    assert (out, told[0]) == (ending.out, told[1])
    assert json.loads((ending.folder / "metrics.json").read_text())["status"] == "ok"
    assert [entry.name for entry in ending.folder.parent.rglob("*") if entry.name.startswith(".")] == []


@pytest.mark.costs(2)
@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-", pytest.param(">&- 2>&-", marks=pytest.mark.slow)])
def test_outputs_may_be_closed(tmp_path, closed):
    command = f'"{sys.executable}" -m runner {" ".join(SHORT)} {closed}'
    ending = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
    assert (ending.returncode, without_caveats(without_results(ending.stderr))) == (0, "")
    (folder,) = (tmp_path / "outputs" / "runs").iterdir()
    assert json.loads((folder / "metrics.json").read_text())["status"] == "ok"


def test_nobody_needs_to_read_to_the_end(tmp_path):
    process = start("list", "robots", cwd=tmp_path)
    process.stdout.close()
    _, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, err) == (0, "")


def test_a_full_standard_output_is_said(tmp_path):
    command = [sys.executable, "-m", "runner", "list", "robots"]
    with open("/dev/full", "w") as full:  # noqa: PTH123 - a device
        ending = subprocess.run(command, cwd=tmp_path, stdout=full, stderr=-1, text=True)
    assert ending.returncode == 2
    assert ending.stderr.startswith("runner: cannot write the output, or ")
    assert ending.stderr.endswith(": No space left on device; free space on its disk\n")
