"""Ctrl-C and SIGTERM while runs are simulated: all processes end, and what is stored is whole."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
from support.patience import PATIENCE, wait_until

import runner
from runner import store
from runner.base import ticks
from runner.sweeps.processes import local_processes

WHOLE = ["config.yaml", "metrics.json", "robot.urdf", "trace.parquet"]
ROWS = 11  # of a trace of 0.1 s; longer runs are simulated before it

pytestmark = pytest.mark.usefixtures("interruptible")


def stored(outputs):
    """Return the durations of stored runs; each must be complete."""
    folders = list((outputs / "runs").glob("*"))
    assert [sorted(path.name for path in folder.iterdir()) for folder in folders] == [WHOLE] * len(folders)
    return sorted(store.open_run(folder).config["duration"] for folder in folders)


@pytest.mark.costs(2)
def test_ctrl_c_does_not_reach_the_processes_of_a_command_as_they_start(tmp_path, capfd):
    """Else they would print what it interrupted; the command ends them."""
    with local_processes(1, tmp_path / "scratch") as processes:
        (first,) = [each for each in psutil.Process().children() if "fork_workers" in "".join(each.cmdline())]
        first.send_signal(signal.SIGINT)
        os.kill(processes.workers[0].pipe.recv(), signal.SIGINT)
    assert processes._first.returncode == 0
    assert capfd.readouterr().err == ""
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


@pytest.mark.costs(5)
@pytest.mark.parametrize(
    ("number", "code", "word", "workers"),
    [
        ("SIGINT", 130, "interrupted", 2),
        ("SIGTERM", 143, "terminated", 1),
        pytest.param("SIGTERM", 143, "terminated", 2, marks=pytest.mark.slow),
    ],
)
def test_a_signal_ends_all_processes_and_says_how_to_go_on(tmp_path, gate, number, code, word, workers):
    """A worker is at a run when the signal comes, and has stored another one."""
    grid = ("robot=macro", "plant=rk4", "duration=0.2,0.1", "seed=0,1", f"hydra.sweeper.workers={workers}")
    command = [sys.executable, "-m", "runner", "--plugin", gate.metric(ROWS), "-m", *grid]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=-1, stderr=-1, text=True, start_new_session=True)
    try:
        output = Path(f"/proc/{gate.next_at()}/fd/2").stat()
        os.killpg(process.pid, signal.Signals[number])  # as Ctrl-C does: to the workers, too
        pipe = os.fstat(process.stderr.fileno())
        out, err = process.communicate(timeout=PATIENCE)  # to the end of a pipe that its workers hold, too
    finally:
        gate.open()
        process.kill()
    assert os.path.samestat(output, pipe)
    assert (process.returncode, out) == (code, "")
    assert err.splitlines()[2:] == [f"runner: {word}; finished runs are stored; the same command continues"]
    assert 1 <= len(stored(tmp_path / "outputs")) <= 2
    assert not list(tmp_path.glob("outputs/sweeps/*/scratch*"))


CLOSING = """\
from pathlib import Path

from runner.sweeps.forked import _closing

UNITS = {{}}


def evaluate(trace, context):
    with Path({ends!r}).open("a") as file:
        file.write("a run\\n")
    stop()
    _closing.wait()
    return {{}}
"""


@pytest.mark.costs(4)
def test_after_ctrl_c_no_further_run_starts(tmp_path, gate):
    """A run ends while its worker closes; nine others of the same worker are left."""
    plugin, ends = tmp_path / "closing.py", tmp_path / "ends"
    plugin.write_text(gate.source + CLOSING.format(ends=str(ends)))
    grid = ("robot=macro", "plant=rk4", "duration=0.1", "seed=range(10)", "hydra.sweeper.workers=1")
    command = [sys.executable, "-m", "runner", "--plugin", f"metric={plugin}", "-m", *grid]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=-1, stderr=-1, text=True, start_new_session=True)
    try:
        gate.next_at()
        os.killpg(process.pid, signal.SIGINT)
        gate.open()
        _, err = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    assert process.returncode == 130, err
    assert ends.read_text() == "a run\n"


@pytest.mark.costs(4)
def test_a_second_ctrl_c_ends_a_sweep_at_once(tmp_path, gate):
    """A worker is at a run, and the command closes its workers, when it comes; both would wait for ever."""
    grid = ("robot=macro", "plant=rk4", "duration=0.1", "seed=0,1", "hydra.sweeper.workers=1")
    words = ("--plugin", gate.metric(ROWS), "-m", *grid)
    command = gate.command("runner.sweeps.processes:_Worker.send", 3, *words)  # two runs, and the end
    process = subprocess.Popen(command, cwd=tmp_path, stdout=-1, stderr=-1, text=True, start_new_session=True)
    try:
        assert gate.next_at() != process.pid
        os.killpg(process.pid, signal.SIGINT)
        assert gate.next_at() == process.pid
        os.killpg(process.pid, signal.SIGINT)
        process.communicate(timeout=PATIENCE)  # to the end of a pipe that its worker holds, too
    finally:
        gate.open()
        process.kill()
    assert process.returncode == -signal.SIGINT
    assert stored(tmp_path / "outputs") == []


def test_a_sweep_of_python_s_that_is_interrupted_leaves_whole_runs_and_goes_on(tmp_path, gate, threads, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = {"robot": "macro", "plant": "rk4", "duration": [0.2, 0.1], "seed": [0, 1], "workers": 0}

    def interrupt():
        gate.next_at()
        os.kill(os.getpid(), signal.SIGINT)

    interrupted = threads.submit(interrupt)
    with pytest.raises(KeyboardInterrupt, match=r"finished runs are stored; the same call continues$"):
        runner.sweep(**words, plugins=[gate.metric(ROWS)])
    interrupted.result(PATIENCE)
    assert stored(tmp_path / "outputs") == [0.2, 0.2]
    (swept,) = (tmp_path / "outputs" / "sweeps").iterdir()
    assert "2 not made yet" in repr(runner.open_sweep(swept))
    gate.open()
    assert "all made" in repr(runner.sweep(**words))


@pytest.mark.parametrize(
    "run",
    [("robot=mini", "repetitions=10000"), ("robot=macro", "plant=rk4", "repetitions=1000000")],
    ids=["tick by tick", "in blocks on threads"],
)
def test_a_run_that_is_interrupted_leaves_nothing(cli, tmp_path, threads, run):
    def interrupt():
        count = ticks.counter()
        wait_until(lambda: count() > 0)
        os.kill(os.getpid(), signal.SIGINT)

    interrupted = threads.submit(interrupt)
    ending = cli(*run)
    interrupted.result(PATIENCE)
    assert (ending.code, ending.out) == (130, "")
    assert ending.err.startswith("runner: interrupted")
    assert list(tmp_path.rglob("metrics.json")) == []
