"""Workers of a running scheduler: two sweeps at once, workers that cannot make runs, and scheduler files."""

import re
import shutil
import socket
import threading

import pytest
from distributed import Client
from support.patience import PATIENCE, wait_until

from runner import store
from runner.assembly.versions import versions
from runner.base.errors import RunnerError, TemporaryError
from runner.plugins.discovery import use_plugins
from runner.sweeps import remote, run
from runner.sweeps.run import Engine

ROWS = 11  # of a trace of 0.1 s
READ_ONLY = (
    "import errno, os\ndef fail(_):\n    raise OSError(errno.EROFS, os.strerror(errno.EROFS))\nos.fsync = fail\n"
)
ELSEWHERE = "import runner.store.physics\nrunner.store.physics.physics_digest = lambda: 'other'\n"
UNKNOWN = "import sys\nsys.modules['runner.sweeps.remote'] = None\n"


def results(ended):
    return {run.hash: (run.metrics, run.failure) for run in store.open_sweep(ended.folder).runs()}


def warnings(capfd):
    return [line.removeprefix("runner: ") for line in capfd.readouterr().err.splitlines() if "arning" in line]


# The scheduler does not know this module, so it receives a function by its code.
count_tasks = lambda dask_scheduler: sum("runs-" in key for key in dask_scheduler.tasks)  # noqa: E731


@pytest.mark.costs(3)
@pytest.mark.parametrize("trace", ["all", "never"])
def test_two_sweeps_at_once_on_one_scheduler_have_their_own_runs(sweep, cluster, gate, threads, tmp_path, trace):
    """The tasks of both are in the scheduler together, under the keys of their first chunks."""
    use_plugins([gate.metric(ROWS)])
    grid = ("duration=0.1", "seed=0,1", f"sweep.trace={trace}")
    there = Engine(0, cluster.address)
    first = threads.submit(sweep, *grid, f"outputs={tmp_path}/first", engine=there)
    gate.next_at()
    second = threads.submit(sweep, *grid, f"outputs={tmp_path}/second", engine=there)
    with Client(cluster.address, set_as_default=False) as client:
        wait_until(lambda: client.run_on_scheduler(count_tasks) == 4)
    gate.open()
    one, two = results(first.result(PATIENCE)), results(second.result(PATIENCE))
    assert len(one) == 2
    assert one == two


@pytest.fixture
def preload(tmp_path):
    """Write code that a worker executes first; return the options of the worker."""

    def write(source):
        (tmp_path / "preload.py").write_text(source)
        return "--preload", str(tmp_path / "preload.py")

    return write


@pytest.mark.costs(4)
@pytest.mark.parametrize(
    ("source", "message"),
    [
        (
            READ_ONLY,
            r"warning: cannot write .*/outputs/.*: Read-only file system \(\S+, tcp://127\.0\.0\.1:\d+\); this",
        ),
        (ELSEWHERE, r"warning: a worker has other source code than the command \(\S+, tcp://127\.0\.0\.1:\d+\); this"),
        (UNKNOWN, r"warning: a worker cannot execute runs \(tcp://127\.0\.0\.1:\d+\): .*; this"),
    ],
    ids=["read-only", "other source", "other version"],
)
def test_a_worker_that_cannot_make_runs_is_left_out_and_named(
    sweep, cluster, preload, capfd, tmp_path, source, message
):
    bad = cluster.add_worker(*preload(source))
    try:
        ended = sweep("seed=range(0,12)", engine=Engine(0, cluster.address))
    finally:
        cluster.end(bad)
    assert results(ended) == results(sweep("seed=range(0,12)", f"outputs={tmp_path}/expected"))
    (line,) = warnings(capfd)
    assert re.match(message, line)


@pytest.mark.costs(3)
def test_a_worker_with_other_source_that_joins_late_is_left_out(sweep, cluster, preload, capfd, monkeypatch, tmp_path):
    monkeypatch.setattr(remote, "_check_workers", lambda _: None)
    bad = cluster.add_worker(*preload(ELSEWHERE))
    try:
        ended = sweep("seed=range(0,12)", engine=Engine(0, cluster.address))
    finally:
        cluster.end(bad)
    assert len(results(ended)) == 12
    (line,) = warnings(capfd)
    assert re.match(
        r"warning: a worker has other source code or libraries .* \(\S+, tcp://127\.0\.0\.1:\d+\); this", line
    )


def test_a_folder_that_no_worker_sees_ends_the_sweep_which_continues(sweep, cluster, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(run, "note", lambda folder: (folder / "sweep.json").unlink())
        with pytest.raises(
            TemporaryError, match=r"a worker does not see .* \(\S+, tcp://\S+\), and no other worker is left; fin"
        ):
            sweep("seed=0,1", engine=Engine(0, cluster.address))
    assert len(results(sweep("seed=0,1", engine=Engine(0, cluster.address)))) == 2


def test_workers_with_other_libraries_are_told_in_one_sentence(sweep, cluster, monkeypatch, capfd):
    theirs = remote.versions()["numpy"]
    monkeypatch.setattr(remote, "versions", lambda: {**versions(), "numpy": "0.1"})
    ended = sweep("seed=0,1", engine=Engine(0, cluster.address))
    assert len(results(ended)) == 2
    (line,) = warnings(capfd)
    assert line.startswith(
        "warning: results may differ in the last digits, because workers have "
        f"numpy {theirs} instead of 0.1 ({socket.gethostname()}, tcp://127.0.0.1:"
    )


def test_a_scheduler_with_other_source_is_refused(sweep, cluster, monkeypatch):
    monkeypatch.setattr(remote, "physics_digest", lambda: "other")
    with pytest.raises(RunnerError, match=r"^the scheduler has other source code than the command; install the same"):
        sweep("seed=0,1", engine=Engine(0, cluster.address))


def test_a_scheduler_file_is_awaited_and_read(sweep, cluster, threads, tmp_path, monkeypatch):
    file, looked = tmp_path / "later.json", threading.Event()
    read = remote.read_text

    def look(path, limit):
        looked.set()
        return read(path, limit)

    monkeypatch.setattr(remote, "read_text", look)
    ended = threads.submit(sweep, "seed=0,1", engine=Engine(0, str(file)))
    assert looked.wait(PATIENCE)
    file.write_text(cluster.file.read_text()[:20])  # as a scheduler that is still writing
    shutil.copy(cluster.file, file)
    assert len(results(ended.result(PATIENCE))) == 2
