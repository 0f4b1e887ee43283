"""One result, wherever the runs are made: in this process, on one or two, on a Dask cluster, and after kills."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from runner import store
from runner.errors import RunnerError
from runner.plugins import use_plugins
from runner.store.identity import source_digest
from runner.sweeps import engine
from runner.sweeps.grid import plan_sweep
from runner.sweeps.queue import Queue
from runner.sweeps.run import Engine, run_sweep

GRID = ("noise=thesis", "robot=macro,mini", "plant=rk4,default", "seed=range(0,4)", "repetitions=2", "duration=0.3")


def results(ended):
    return {run.hash: (run.metrics, run.failure) for run in store.open_sweep(ended.folder).runs()}


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    plan = plan_sweep([*GRID, f"outputs={tmp_path_factory.mktemp('expected')}"], ())
    return results(run_sweep(plan, Engine(0, None), "runner -m ..."))


@pytest.fixture
def scheduler(tmp_path):
    """A scheduler with two workers, each a process of its own; gives its address and the workers."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    quiet = {"cwd": tmp_path, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [sys.executable, "-m", "dask"]
    processes = [
        subprocess.Popen([*command, "scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"], **quiet)
    ]
    worker = [*command, "worker", address, "--nthreads", "1", "--no-dashboard"]
    processes += [subprocess.Popen([*worker, *how], **quiet) for how in (["--no-nanny"], ["--no-nanny"])]
    yield address, processes
    for process in processes:
        process.kill()
        process.wait()


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_processes_of_this_machine_give_what_this_process_gives(sweep, expected, workers, tmp_path):
    assert results(sweep(*GRID, engine=Engine(workers, None))) == expected
    assert [path for path in tmp_path.rglob("*") if path.name.startswith(".") or path.name == "scratch"] == []


def test_a_running_cluster_gives_it_too_though_a_worker_is_killed(sweep, expected, scheduler, tmp_path):
    address, processes = scheduler

    def kill():
        while not list((tmp_path / "outputs" / "runs").glob("*/metrics.json")):
            time.sleep(0.01)
        processes[1].kill()

    killer = threading.Thread(target=kill)
    killer.start()
    ended = sweep(*GRID, engine=Engine(0, address))
    killer.join()
    assert results(ended) == expected
    assert processes[2].poll() is None


PULL = """\
import numpy as np

from runner.registry import StrictModel


class CONFIG(StrictModel):
    kind: str


class Pull:
    def reset(self, tip):
        pass

    def wrench(self, time, tip, velocity):
        return np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def build(config):
    return Pull()
"""


SLOW_PULL = "from time import sleep\n\n" + PULL.replace("        return", "        sleep(0.02)\n        return")


@pytest.fixture
def pulls(tmp_path, monkeypatch):
    """Make an environment of the user's from its name and source; returns its config folder."""

    def make(name, source):
        (tmp_path / "mine/environment").mkdir(parents=True)
        (tmp_path / f"mine/environment/{name}.yaml").write_text(f"kind: {name}\n")
        (tmp_path / f"mine/{name}.py").write_text(source)
        monkeypatch.setenv("RUNNER_PLUGINS", "")
        monkeypatch.setattr(sys, "path", [*sys.path])
        use_plugins([f"environment={tmp_path}/mine/{name}.py"])
        return tmp_path / "mine"

    return make


def test_workers_of_a_cluster_take_the_parts_that_the_command_names(sweep, scheduler, pulls):
    grid = ("environment=pull", "duration=0.1", "seed=0,1")
    ended = sweep(*grid, engine=Engine(0, scheduler[0]), config_dirs=[pulls("pull", PULL)])
    assert [run.status for run in store.open_sweep(ended.folder).runs()] == ["ok", "ok"]


def test_a_worker_tells_how_far_a_long_run_is(sweep, pulls, monkeypatch):
    told = []
    monkeypatch.setattr(Queue, "tell", lambda _, chunk, ticks: told.append((chunk, ticks)))
    overrides = ("environment=slow_pull", "duration=1.5", "controller.period=0.01")
    sweep(*overrides, engine=Engine(1, None), config_dirs=[pulls("slow_pull", SLOW_PULL)])
    chunks, ticks = zip(*told, strict=True)
    assert len(set(chunks)) == 1
    assert list(ticks) == sorted(ticks)
    assert 0 < ticks[-1] <= 150


def test_a_scheduler_that_is_lost_is_said(sweep, scheduler, tmp_path):
    address, processes = scheduler

    def kill():
        while not list((tmp_path / "outputs" / "runs").glob("*/metrics.json")):
            time.sleep(0.01)
        processes[0].kill()

    threading.Thread(target=kill).start()
    with pytest.raises(RunnerError, match=r"^the Dask scheduler is lost; finished runs are stored"):
        sweep(*GRID, "seed=range(0,400)", engine=Engine(0, address))


def alive(group):
    """Count processes of a group that run still; state, parent and group follow the command in /proc/PID/stat."""
    count = 0
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # it ended meanwhile
            state, _, its_group, *_ = path.read_text().rpartition(")")[2].split()
            count += int(its_group) == group and state != "Z"
    return count


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_waits_until_the_processes_have_started():
    """Else a part of a cluster would be left, and its processes, still without our code, would tell of it."""
    before, began = signal.getsignal(signal.SIGINT), []

    def start():
        with engine._undisturbed():
            signal.raise_signal(signal.SIGINT)
            began.append(subprocess.run([sys.executable, "-c", "import signal; signal.raise_signal(2)"], check=False))

    with pytest.raises(KeyboardInterrupt):
        start()
    assert [child.returncode for child in began] == [0]
    assert signal.getsignal(signal.SIGINT) is before
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


@pytest.mark.parametrize(
    ("number", "code", "word", "workers"),
    [
        ("SIGINT", 130, "interrupted", 2),
        ("SIGTERM", 143, "terminated", 1),
        pytest.param("SIGTERM", 143, "terminated", 2, marks=pytest.mark.slow),
    ],
)
def test_a_signal_ends_all_processes_and_says_how_to_go_on(tmp_path, number, code, word, workers):
    grid = ["robot=macro", "plant=rk4", "seed=range(0,2000)", f"hydra.sweeper.workers={workers}"]
    command = [sys.executable, "-m", "runner", "-m", *grid]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=-1, stderr=-1, text=True, start_new_session=True)
    while not list(tmp_path.glob("outputs/runs/*/metrics.json")):
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.Signals[number])  # as Ctrl-C does: to the workers, too
    try:
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, out) == (code, "")
    assert err.splitlines()[2:] == [f"runner: {word}; finished runs are stored; the same command continues"]
    deadline = time.monotonic() + 20
    while alive(process.pid):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    assert not list(tmp_path.glob("outputs/sweeps/*/scratch"))


DEADLY = """\
import multiprocessing
import os

UNITS = {}


def evaluate(trace, context):
    if multiprocessing.parent_process() is not None and len(trace.t) == 31:
        os._exit(1)
    return {}
"""


@pytest.fixture
def deadly_metric(tmp_path, monkeypatch):
    """A metric of another package that brings a worker's process down after 30 ticks."""
    for name, text in (
        ("deadly.py", DEADLY),
        ("deadly-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: deadly\nVersion: 1.0\n"),
        ("deadly-1.0.dist-info/entry_points.txt", "[runner.metric]\ndeadly = deadly\n"),
    ):
        (tmp_path / "site" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "site" / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path / "site")
    source_digest.cache_clear()
    yield
    source_digest.cache_clear()
    sys.modules.pop("deadly", None)


@pytest.mark.usefixtures("deadly_metric")
@pytest.mark.parametrize("deaths", [0, *(pytest.param(many, marks=pytest.mark.slow) for many in (1, 3))])
def test_a_run_that_brings_its_workers_down_is_cut_short_and_the_others_are_made(sweep, monkeypatch, deaths):
    monkeypatch.setattr(engine, "_DEATHS", deaths)
    ended = sweep("duration=0.1,0.2,0.3,0.4,0.5", engine=Engine(1, None))
    ((overrides, why, log),) = ended.failures
    assert "duration=0.3" in overrides
    assert why == f"cut short: its worker process died {deaths + 1} times"
    assert why in log.read_text()
    assert [run.status for run in store.open_sweep(ended.folder).runs()] == ["ok", "ok", "failed", "ok", "ok"]
