"""One result, wherever the runs are simulated: in this process, on processes of this machine, on a Dask cluster."""

import os
import shutil
import subprocess
import sys

import psutil
import pytest
from support.clusters import Cluster
from support.patience import PATIENCE
from support.short_runs import DAMPING, FREQUENCY

from runner import store
from runner.base.errors import RunnerError, TemporaryError
from runner.plugins.discovery import use_plugins
from runner.sweeps import processes
from runner.sweeps.estimate import Estimate
from runner.sweeps.processes import local_processes
from runner.sweeps.queue import Queue
from runner.sweeps.run import Engine

GRID = ("noise=thesis", "robot=macro,mini", "plant=rk4,default", "seed=0,1", "repetitions=2", "duration=0.2,0.1")
ROWS = 11  # of a trace of 0.1 s; longer runs are simulated before it
BY_WORKERS = "sweep.time_limit=600"  # without it this process simulates a short sweep


def results(ended):
    return {run.hash: (run.metrics, run.failure) for run in store.open_sweep(ended.folder).runs()}


def assert_nothing_is_left(folder):
    assert [path for path in folder.rglob("*") if path.name.startswith(".") or path.name.startswith("scratch")] == []


@pytest.fixture
def expected(sweep, tmp_path):
    return results(sweep(*GRID, f"outputs={tmp_path}/expected"))


@pytest.mark.slow  # the processes of the last test of this file do the same
def test_processes_of_this_machine_give_what_this_process_gives(sweep, expected, tmp_path):
    assert results(sweep(*GRID, BY_WORKERS, engine=Engine(2, None))) == expected
    assert_nothing_is_left(tmp_path)


@pytest.mark.costs(2)
def test_a_running_cluster_gives_what_this_process_gives(sweep, expected, cluster):
    assert results(sweep(*GRID, engine=Engine(0, cluster.address))) == expected


@pytest.mark.costs(3)
def test_the_runs_of_a_worker_that_is_killed_are_made_by_others(sweep, cluster, gate, threads, tmp_path):
    """Each of three workers is at a run when one of them is killed."""
    use_plugins([gate.metric(ROWS)])
    doomed = cluster.add_worker()
    overrides = ("duration=0.1", "seed=range(0,6)")

    def kill():
        at_work = {gate.next_at() for _ in cluster.workers}
        cluster.end(doomed)
        gate.open()
        return at_work

    killed = threads.submit(kill)
    ended = sweep(*overrides, engine=Engine(0, cluster.address))
    assert doomed.pid in killed.result(PATIENCE)
    assert results(ended) == results(sweep(*overrides, f"outputs={tmp_path}/expected"))
    assert [worker.poll() for worker in cluster.workers] == [None, None]


@pytest.mark.costs(2)
def test_trials_of_a_tuning_do_not_depend_on_where_they_are_made(tuned, cluster, tmp_path):
    whole = tuned(trials=13)
    address = f"hydra.sweeper.address={cluster.address}"
    other = tuned(FREQUENCY, DAMPING, address, f"outputs={tmp_path}/other", trials=13)
    assert other.trials == whole.trials
    assert other.folder.name == whole.folder.name
    for trial in whole.trials:
        one, two = (store.open_run(tmp_path / place / "runs" / trial.run) for place in ("outputs", "other"))
        assert one.metrics == two.metrics


PULL = """\
import numpy as np

from runner.plugins.registry import StrictModel


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


@pytest.fixture
def pulls(tmp_path):
    """Make an environment of the user from its name and source; returns its config folder."""

    def make(name, source):
        (tmp_path / "mine/environment").mkdir(parents=True)
        (tmp_path / f"mine/environment/{name}.yaml").write_text(f"kind: {name}\n")
        (tmp_path / f"mine/{name}.py").write_text(source)
        use_plugins([f"environment={tmp_path}/mine/{name}.py"])
        return tmp_path / "mine"

    return make


SPAN = 'UNITS = {"span": "s"}\n\n\ndef evaluate(trace, context):\n    return {"span": float(trace.t[-1])}\n'


def test_workers_of_a_cluster_take_the_plug_ins_of_the_command_and_no_others(
    sweep, cluster, pulls, tmp_path, monkeypatch
):
    (tmp_path / "span.py").write_text(SPAN)
    use_plugins([f"metric={tmp_path}/span.py"])
    remote, folder = Engine(0, cluster.address), pulls("pull", PULL)
    ended = sweep("environment=pull", "duration=0.1", "seed=0,1", engine=remote, config_dirs=[folder])
    assert [run.metrics["span"].median for run in store.open_sweep(ended.folder).runs()] == [0.1, 0.1]
    monkeypatch.setenv("RUNNER_PLUGINS", "")  # as in the next command
    ended = sweep("duration=0.1", "seed=0,1", engine=remote)
    assert ["span" in run.metrics for run in store.open_sweep(ended.folder).runs()] == [False, False]


def test_a_worker_tells_how_far_a_long_run_is(sweep, cluster, pulls, gate, monkeypatch):
    """The run waits at its 50th tick until the queue knows of ticks."""
    told = []

    def note(_, chunk, ticks):
        told.append((chunk, ticks))
        if ticks:
            gate.open()

    monkeypatch.setattr(Queue, "tell", note)
    monkeypatch.setattr("runner.sweeps.run.estimate", lambda *_: Estimate(1.0))  # which would wait, too
    waits = "        if time > 0.495:\n            stop()\n        return np"
    source = gate.source + PULL.replace("        return np", waits)
    overrides = ("environment=long_pull", "duration=1.5", "controller.period=0.01")
    sweep(*overrides, engine=Engine(0, cluster.address), config_dirs=[pulls("long_pull", source)])
    chunks, ticks = zip(*told, strict=True)
    assert len(set(chunks)) == 1
    assert list(ticks) == sorted(ticks)
    assert 40 <= next(filter(None, ticks)) <= 60
    assert ticks[-1] <= 150


@pytest.mark.costs(5)
def test_a_scheduler_that_is_lost_is_said(sweep, gate, threads, tmp_path):
    """It is killed after a stored run, while the worker is at another one."""
    use_plugins([gate.metric(ROWS)])
    (tmp_path / "doomed").mkdir()
    doomed = Cluster(tmp_path / "doomed", workers=1)

    def kill():
        gate.next_at()
        doomed.scheduler.kill()

    killed = threads.submit(kill)
    try:
        with pytest.raises(RunnerError, match=r"^the Dask scheduler is lost; finished runs are stored"):
            sweep("duration=0.2,0.1", engine=Engine(0, doomed.address))
    finally:
        doomed.close()
    killed.result(PATIENCE)
    (stored,) = (tmp_path / "outputs/runs").glob("*/metrics.json")
    assert store.open_run(stored.parent).config["duration"] == 0.2


def places(pid):
    """Return the addresses of the sockets of a process; a pipe has none."""
    return {each.laddr for each in psutil.Process(pid).net_connections("all")} - {""}


@pytest.mark.costs(2)
def test_no_other_process_can_reach_the_workers_of_this_machine(tmp_path):
    with local_processes(2, tmp_path / "scratch") as processes:
        pids = [worker.pipe.recv() for worker in processes.workers]
        first = psutil.Process(pids[0]).parent()
        assert [each.pid for each in first.children()] == pids
        assert [places(pid) for pid in (first.pid, *pids)] == [set(), set(), set()]
    assert [psutil.pid_exists(pid) for pid in (first.pid, *pids)] == [False, False, False]
    assert not (tmp_path / "scratch").exists()


@pytest.mark.costs(2)
def test_a_worker_that_ends_before_it_could_work_is_said(sweep, monkeypatch):
    monkeypatch.setattr("runner.sweeps.processes.sys.executable", shutil.which("true"))
    with pytest.raises(TemporaryError, match=r"^a worker process ended as it started; finished runs are stored"):
        sweep("duration=0.05", "seed=0,1", BY_WORKERS, engine=Engine(2, None))


# It does not guard itself by `if __name__ == "__main__"`, and a process that began it again would be seen.
PLAIN = """\
print("begins")
import runner
sweep = runner.sweep("robot=macro", "duration=0.05", seed=range(2), workers=1)
print(len(list(sweep.runs())), __file__, __spec__)
"""


@pytest.mark.costs(5)
def test_a_plain_script_makes_a_sweep_on_processes(tmp_path):
    (tmp_path / "plain.py").write_text(PLAIN)
    ending = subprocess.run([sys.executable, "plain.py"], cwd=tmp_path, capture_output=True, text=True)
    assert ending.returncode == 0, ending.stderr
    assert ending.stdout.splitlines() == ["begins", f"2 {tmp_path / 'plain.py'} None"]


DEADLY = """\
import os

UNITS = {{}}


def evaluate(trace, context):
    if os.getpid() != {command} and len(trace.t) == 31:
        os._exit(1)
    return {{}}
"""


@pytest.fixture
def deadly_metric(tmp_path, monkeypatch):
    """A metric of another package that brings a worker's process down after 30 ticks."""
    for name, text in (
        ("deadly.py", DEADLY.format(command=os.getpid())),
        ("deadly-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: deadly\nVersion: 1.0\n"),
        ("deadly-1.0.dist-info/entry_points.txt", "[runner.metric]\ndeadly = deadly\n"),
    ):
        (tmp_path / "site" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "site" / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path / "site")
    yield
    sys.modules.pop("deadly", None)


@pytest.mark.costs(5)
@pytest.mark.usefixtures("deadly_metric")
@pytest.mark.parametrize("deaths", [1, pytest.param(4, marks=pytest.mark.slow)])
def test_a_run_that_brings_its_workers_down_is_cut_short_and_the_others_are_as_made_in_this_process(
    sweep, monkeypatch, tmp_path, deaths
):
    monkeypatch.setattr(processes, "_DEATHS", deaths)
    overrides = ("noise=thesis", "repetitions=2", "duration=0.2,0.3,0.4")
    ended = sweep(*overrides, engine=Engine(1, None))
    ((cell, why, log),) = ended.failures
    assert "duration=0.3" in cell
    assert why == f"cut short: its worker process died {deaths} times"
    assert why in log.read_text()
    assert_nothing_is_left(tmp_path)
    expected = results(sweep(*overrides, f"outputs={tmp_path}/expected"))
    found = results(ended)
    assert list(found) == list(expected)
    assert [name for name in found if found[name] != expected[name]] == [log.stem]
