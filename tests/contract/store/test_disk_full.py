"""A disk that takes no more, by a limit on the size of files: one sentence, nothing lost, repeatable."""

import resource
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

CASE = ("robot=macro", "plant=rk4", "controller=computed_torque", "duration=0.5", "noise=thesis")


@contextmanager
def largest_file(size):
    """Let no file of this process grow beyond a size, in bytes; Python writes no byte code, which it would cut off."""
    before, sys.dont_write_bytecode = resource.getrlimit(resource.RLIMIT_FSIZE), True
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        sys.dont_write_bytecode = False


def contents(folder=Path()):
    """Content of each file by its path."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


COMMANDS = {
    "run": (*CASE, "seed=1"),
    "sweep": ("-m", *CASE, "seed=1,2", "hydra.sweeper.workers=0"),
    "sweep without traces": ("-m", *CASE, "seed=1,2", "hydra.sweeper.workers=0", "sweep.trace=never"),
    "tuning": ("tune", *CASE, "controller.natural_frequency=interval(10,20)", "--minimize", "peak_torque", "--trials",
               "2", "hydra.sweeper.workers=0"),
}  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS)
def test_what_was_stored_stays_and_the_same_command_goes_on(cli, command):
    arguments = COMMANDS[command]
    stored = cli(*CASE).folder
    before = contents(stored)
    with largest_file(3000):
        ending = cli(*arguments)
    assert ending.code == (2 if command == "run" else 75)
    told = ending.err.splitlines()[-1]
    assert told.startswith("runner: cannot write ")
    assert "File too large; free space on its disk" in told
    assert contents(stored) == before
    assert not list(Path().rglob(".*.tmp"))
    assert [path.parent for path in Path("outputs").rglob("metrics.json")] == [stored.relative_to(Path.cwd())]
    assert cli(*arguments).code == 0
    assert cli("verify").code == 0


def test_a_report_stays_as_it_was(cli):
    run = cli(*CASE).folder
    page = cli("report", run, "--format", "html").folder / "report.html"
    before = page.read_bytes()
    with largest_file(100_000):
        ending = cli("report", run, "--format", "html")
    assert ending.code == 2
    assert ending.err == f"runner: cannot write {page}: File too large; free space on its disk\n"
    assert page.read_bytes() == before
    assert not list(page.parent.glob(".*.tmp"))
