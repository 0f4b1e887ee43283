"""Execution of a queue in the current process, or on a running Dask cluster."""

import contextlib
import socket
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import CancelledError
from dataclasses import replace
from functools import partial
from typing import Any

from runner.base.errors import TemporaryError
from runner.sweeps.queue import Queue
from runner.sweeps.remote import GO_ON, Remote, in_place
from runner.sweeps.work import Chunk, ChunkResult, give_up, work

_LOOK_EVERY = 5.0  # s between two looks for workers
_BACK_WITHIN = 120.0  # s without any worker


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


def on_cluster(queue: Queue, remote: Remote) -> Generator[ChunkResult]:
    """Process a queue on a Dask cluster with a bounded number of chunks in flight; yield the report of each chunk.

    Args:
        queue: The queue.
        remote: The workers; one that cannot make runs is left out.

    Raises:
        TemporaryError: if the scheduler is lost, all workers are lost for good, or none of them can make runs.
    """
    from distributed.scheduler import KilledWorker

    client = remote.client
    under_way: dict[Any, tuple[Chunk, Sequence[str] | None]] = {}  # chunk, and the workers to which it is restricted
    suspects: set[str] = set()

    def submit(chunk: Chunk) -> None:
        only = remote.only()
        future = client.submit(_work, chunk, topic, key=f"runs-{chunk.name}", pure=False, workers=only)
        under_way[future] = chunk, only

    def fill() -> None:
        workers = max(1, len(remote.usable()))
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
                if report.trouble:
                    report = _without_worker(report, chunk, queue, remote)
            elif future.status in ("cancelled", "lost"):
                raise CancelledError("its tasks are gone")
            elif isinstance(error := future.exception(), KilledWorker):
                # All runs that the worker had are suspects until each has been made separately.
                is_cause = chunk.name in suspects
                report = (
                    give_up(chunk, error.allowed_failures + 1)
                    if is_cause
                    else ChunkResult(queue.give_back(chunk), "", 0.0)
                )
            else:
                raise error
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
