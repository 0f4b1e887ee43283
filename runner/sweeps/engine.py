"""Execution engine of sweeps: Dask on this machine, Dask on a running cluster, or the current process."""

import asyncio
import contextlib
import logging
import shutil
import signal
import socket
import threading
import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from dataclasses import replace
from functools import partial
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

from runner.base.errors import RunnerError, TemporaryError
from runner.sweeps.deadline import STUCK
from runner.sweeps.queue import Queue
from runner.sweeps.remote import GO_ON, Remote, hush, in_place
from runner.sweeps.work import Chunk, ChunkResult, give_up, work

_DEATHS = 3  # worker deaths during one run before the run counts as the cause
_LOOK_EVERY = 5.0  # s between two looks for workers
_BACK_WITHIN = 120.0  # s without any worker
# The next batch of runs reuses freed memory. Otherwise the system would clear 250 KB of fresh pages for each run.
_MEMORY = {"MALLOC_TRIM_THRESHOLD_": 2**28, "MALLOC_MMAP_THRESHOLD_": 2**25}  # bytes
_END_WITHIN = 0.5  # s for a worker after Ctrl-C


def in_process(queue: Queue, go_on: Callable[[], bool] = lambda: True) -> Generator[ChunkResult]:
    """Process a queue in this process; yield the report of each chunk.

    Args:
        queue: The queue.
        go_on: Function called before each chunk; the engine stops if it returns False.
    """
    while go_on() and (chunk := queue.take(1)) is not None:
        report = work(chunk, partial(queue.tell, chunk.name))
        queue.end(chunk)
        queue.learn(report)
        yield report


def on_cluster(queue: Queue, client: Any, remote: Remote | None = None) -> Generator[ChunkResult]:
    """Process a queue on a Dask cluster with a bounded number of chunks in flight; yield the report of each chunk.

    Args:
        queue: The queue.
        client: A `distributed.Client`.
        remote: The workers of the client if they are on other machines: one that cannot make runs is left out.

    Raises:
        TemporaryError: if the scheduler is lost, all workers are lost for good, or none of them can make runs.
    """
    from distributed.scheduler import KilledWorker

    under_way: dict[Any, tuple[Chunk, Sequence[str] | None]] = {}  # chunk, and the workers to which it is restricted
    suspects: set[str] = set()

    def submit(chunk: Chunk) -> None:
        only = remote.only() if remote else None
        future = client.submit(_work, chunk, topic, key=f"runs-{chunk.name}", pure=False, workers=only)
        under_way[future] = chunk, only

    def fill() -> None:
        workers = max(1, len(remote.usable() if remote else client.nthreads()))
        while len(under_way) < 2 * workers and (chunk := queue.take(workers)) is not None:
            submit(chunk)
        if not under_way and (suspect := queue.take_suspect()) is not None:
            suspects.add(suspect.name)
            submit(suspect)

    # Topics and keys are global in a scheduler: the same key of two commands is one task.
    topic = f"ticks-{queue.rules.command}"
    client.subscribe_topic(topic, lambda event: queue.tell(*event[1]))
    try:
        fill()
        while under_way:
            future = _next_done(client, {future: only for future, (_, only) in under_way.items()})
            chunk, _ = under_way.pop(future)
            queue.end(chunk)
            if future.status == "finished":
                report = future.result()
                if report.trouble and remote is not None:
                    report = _without_worker(report, chunk, queue, remote)
            elif future.status in ("cancelled", "lost"):
                raise CancelledError("its tasks are gone")
            elif isinstance(future.exception(), KilledWorker):
                # All runs that the worker had are suspects until each has been made separately.
                report = _give_up(chunk) if chunk.name in suspects else ChunkResult(queue.give_back(chunk), "", 0.0)
            else:
                raise future.exception()
            future.release()
            queue.learn(report)
            fill()
            yield report
    except (OSError, CancelledError) as error:
        raise TemporaryError(f"the Dask scheduler is lost; {GO_ON}") from error
    finally:
        client.cancel(list(under_way))


def _work(chunk: Chunk, topic: str) -> ChunkResult:
    """Execute the jobs of a chunk in a worker, which publishes the number of finished ticks on a topic.

    A worker that closes, as after Ctrl-C, starts no further job.
    """
    from distributed import Status, get_worker

    worker = get_worker()
    try:
        report = work(
            chunk,
            lambda ticks: worker.log_event(topic, (chunk.name, ticks)),
            lambda: worker.status not in (Status.closing, Status.closed),
        )
    except OSError as error:
        report = ChunkResult([], f"a worker failed: {error}", 0.0)
    return replace(report, host=socket.gethostname(), worker=worker.address)


def _without_worker(report: ChunkResult, chunk: Chunk, queue: Queue, remote: Remote) -> ChunkResult:
    """Leave out a worker that reported trouble, and queue its missing jobs again; return the stored ones.

    Raises:
        TemporaryError: if no other worker is left.
    """
    reason = in_place(report.trouble, report.host, report.worker)
    if not set(remote.usable()) - {report.worker}:
        raise TemporaryError(f"{reason}, and no other worker is left; {GO_ON}")
    remote.leave_out(report.worker, reason)
    return ChunkResult(queue.give_back(chunk, as_suspects=False), "", 0.0)


def _next_done(client: Any, futures: Mapping[Any, Sequence[str] | None]) -> Any:
    """Return the next future that is done; `futures` gives the workers to which each is restricted."""
    from distributed import wait

    last_seen = time.monotonic()
    while not any(future.done() for future in futures):
        workers = set(client.nthreads())
        if any(workers if only is None else workers.intersection(only) for only in futures.values()):
            last_seen = time.monotonic()
        elif time.monotonic() - last_seen > _BACK_WITHIN:
            raise TemporaryError(f"all workers are gone and none came back for {_BACK_WITHIN:g} s; {GO_ON}")
        with contextlib.suppress(TimeoutError):
            wait(list(futures), timeout=_LOOK_EVERY, return_when="FIRST_COMPLETED")
    return next(future for future in futures if future.done())


def _give_up(chunk: Chunk) -> ChunkResult:
    reason = f"its worker process died {_DEATHS + 1} times"
    if chunk.rules.settings.time_limit is not None:
        reason += f", by itself or because it could not be interrupted for {STUCK:g} s after sweep.time_limit"
    return give_up(chunk, reason)


@contextlib.contextmanager
def local_client(workers: int, scratch: Path) -> Iterator[Any]:
    """Start a cluster of single-threaded processes on this machine; yield its `distributed.Client`.

    Scheduler and workers authenticate each other with a temporary key that is kept in memory, so no other process can
    run code on the cluster. Neither has an HTTP server.

    Args:
        workers: Number of processes.
        scratch: Folder for all temporary files of the cluster and of its jobs; it is removed at the end.

    Raises:
        RunnerError: if the processes cannot be started.
    """
    import dask
    from distributed import Client

    scratch.mkdir(parents=True, exist_ok=True)
    hush()
    settings = {
        "distributed.scheduler.allowed-failures": _DEATHS,
        # A dead worker is restarted. By default, Dask drops a worker that is down 15 s after an earlier death.
        "distributed.deploy.lost-worker-timeout": "1000 days",
        "distributed.worker.memory.terminate": False,
        "distributed.admin.system-monitor.gil.enabled": False,
        "distributed.nanny.environ": {"OMP_NUM_THREADS": 1, "TMPDIR": str(scratch)},
        **{f"distributed.nanny.pre-spawn-environ.{name}": value for name, value in _MEMORY.items()},
    }
    try:
        with dask.config.set(settings), contextlib.ExitStack() as stack:
            with _undisturbed():
                cluster = stack.enter_context(_start_cluster(workers, scratch))
            client = stack.enter_context(Client(cluster))
            try:
                yield client
            except KeyboardInterrupt:
                cluster.sync(_end_workers, cluster)
                raise
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


async def _end_workers(cluster: Any) -> None:
    """End the processes of a cluster soon; by default each has 4 s for its running job."""
    await asyncio.gather(*(nanny.close(timeout=_END_WITHIN) for nanny in cluster.workers.values()))


@contextlib.contextmanager
def _undisturbed() -> Iterator[None]:
    """Delay Ctrl-C until the body has ended; processes started in the body never receive it.

    A partly started cluster cannot be ended. A process that is still importing its code would print a traceback.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    resource_tracker.ensure_running()  # as it starts, it unblocks Ctrl-C in its thread
    held: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: held.append(number))
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        signal.signal(signal.SIGINT, before)
    if held:
        raise KeyboardInterrupt


def _start_cluster(workers: int, scratch: Path) -> Any:
    from distributed import Nanny, Security, SpecCluster

    from runner.sweeps.closed_nodes import ClosedScheduler, ClosedWorker

    security = Security.temporary()
    shared = {"host": "127.0.0.1", "protocol": "tls://", "security": security, "dashboard": False}
    own = {
        "worker_class": ClosedWorker,
        "nthreads": 1,
        "memory_limit": 0,
        "local_directory": str(scratch),
        "preload": "runner.sweeps.work",  # for its dask_setup
        "silence_logs": logging.CRITICAL,
    }
    try:
        return SpecCluster(
            scheduler={"cls": ClosedScheduler, "options": shared},
            workers={number: {"cls": Nanny, "options": {**shared, **own}} for number in range(workers)},
            security=security,
            silence_logs=logging.CRITICAL,
        )
    except (RuntimeError, OSError) as error:
        raise RunnerError(
            f"the worker processes cannot be started: {str(error).rstrip('.')}; check the limits of open files and "
            "processes (`ulimit -a`), or set hydra.sweeper.workers=0, which needs no worker processes"
        ) from error
