"""Workers and commands killed at named points of a sweep and a tuning; `python -m tools kills` draws the points."""

import os
import signal
import subprocess
import sys
from dataclasses import replace

import pytest
from support.patience import PATIENCE
from support.short_runs import DAMPING, FREQUENCY, SHORT

from runner.store import open_sweep
from tools.kills import Stored

IN_PROCESS = "hydra.sweeper.workers=0"


@pytest.fixture
def killed(tmp_path, gate):
    """Kill a command, and every process that it started, at the gate."""

    def kill(command):
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        with subprocess.Popen(command, cwd=tmp_path, start_new_session=True, **quiet) as process:
            try:
                gate.next_at()
            finally:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait(PATIENCE)

    return kill


@pytest.mark.costs(3)
@pytest.mark.parametrize(("trace", "calls"), [("all", 8), ("never", 5)])
def test_a_command_that_is_killed_while_it_writes_loses_doubles_and_leaves_nothing(
    cli, tmp_path, gate, killed, trace, calls
):
    """At the first file of its third run, or at its second shard."""
    grid = ("robot=macro", "plant=rk4", "noise=thesis", "seed=range(0,8)", "repetitions=4", "duration=0.1")
    command = ("-m", *grid, IN_PROCESS, f"sweep.trace={trace}")
    stored = Stored(tmp_path / "outputs")
    killed(gate.command("os:fsync", calls, *command))
    stored.look()
    assert 0 < len(stored.made) < 8
    ended = cli(*command)
    assert [run.status for run in open_sweep(ended.folder).runs()] == ["ok"] * 8
    tally = stored.tally(workers=0, commands=1)
    assert (tally.runs, tally.lost, tally.doubled, tally.leftovers) == (8, 0, 0, [])


@pytest.mark.costs(7)
@pytest.mark.parametrize(("trace", "calls"), [("all", 6), ("never", 3)])
def test_a_part_that_is_killed_and_started_again_gives_the_sweep_of_one_command(
    cli, tmp_path, gate, killed, trace, calls
):
    """While it writes a run or a shard; names, metrics and the bytes of the table agree."""
    grid = ("robot=macro", "plant=rk4", "noise=thesis", "noise.position=0,1e-3", "seed=range(0,6)", "duration=0.1")
    command = ("-m", *grid, IN_PROCESS, f"sweep.trace={trace}")
    stored = Stored(tmp_path / "outputs")
    cli(*command, "sweep.part=2/3")
    before = len(stored.look())
    killed(gate.command("os:fsync", calls, *command, "sweep.part=0/3"))
    assert len(stored.look()) > before
    cli(*command, "sweep.part=1/3")
    ended = cli(*command, "sweep.part=0/3")
    tally = stored.tally(workers=0, commands=1)
    assert (tally.runs, tally.lost, tally.doubled, tally.leftovers) == (12, 0, 0, [])
    whole = cli(*command, "-o", "whole")
    assert ended.folder.name == whole.folder.name
    for name in ("table.parquet", "table.csv"):
        one, other = (
            (cli("table", folder), (folder / name).read_bytes())[1] for folder in (ended.folder, whole.folder)
        )
        assert one == other


@pytest.mark.costs(5)
def test_a_worker_that_is_killed_and_its_command_after_it_lose_double_and_leave_nothing(cli, tmp_path, gate):
    """Both between stored runs and such that are to come."""
    grid = ("robot=macro", "plant=rk4", "noise=thesis", "duration=0.2,0.1", "seed=0,1", "sweep.trace=never")
    words = ("--plugin", gate.metric(rows=11), "-m", *grid)
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [sys.executable, "-m", "runner", *words, "hydra.sweeper.workers=1"]
    stored = Stored(tmp_path / "outputs")
    with subprocess.Popen(command, cwd=tmp_path, start_new_session=True, **quiet) as process:
        try:
            worker = gate.next_at()
            stored.look()
            os.kill(worker, signal.SIGKILL)
            assert gate.next_at() != worker
        finally:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait(PATIENCE)
    stored.look()
    gate.open()
    ended = cli(*words, IN_PROCESS)
    assert [run.status for run in open_sweep(ended.folder).runs()] == ["ok"] * 4
    tally = stored.tally(workers=1, commands=1)
    assert (tally.runs, tally.lost, tally.doubled, tally.leftovers) == (4, 0, 0, [])


@pytest.mark.costs(5)
def test_a_tuning_that_is_killed_ends_as_if_it_had_not_been(tuned, tmp_path, gate, killed):
    """After two lines in the journal, with runs simulated in the command and in its own process."""
    whole = tuned(trials=12)
    overrides = (*SHORT, f"outputs={tmp_path}/killed", FREQUENCY, DAMPING)
    options = ("--minimize=peak_torque", "--trials=12", "--jobs=3")
    for workers in (0, 1):
        words = ("tune", *overrides, *options, f"hydra.sweeper.workers={workers}")
        killed(gate.command("runner.sweeps.tuning.journal:Journal.append", 2, *words))
    journal = next((tmp_path / "killed" / "tunings").glob("*/journal.log"))
    assert len(journal.read_text().splitlines()) == 1 + 2 + 2
    other = tuned(FREQUENCY, DAMPING, f"outputs={tmp_path}/killed", trials=12)
    assert other.trials == whole.trials
    assert not [
        *(tmp_path / "killed").rglob("*.tmp"),
        *(tmp_path / "killed").rglob("scratch*"),
        *(tmp_path / "killed").rglob("at_work-*"),
    ]
    assert replace(other, folder=whole.folder) == whole
