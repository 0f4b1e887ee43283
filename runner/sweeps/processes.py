"""Worker processes of a command on this machine, each at the end of a pipe that no other process can reach."""

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
from collections import Counter, deque
from collections.abc import Generator, Iterator
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from pathlib import Path

from runner.base.errors import RunnerError, TemporaryError
from runner.sweeps.queue import Queue
from runner.sweeps.remote import GO_ON
from runner.sweeps.work import Chunk, ChunkResult, give_up

_DEATHS = 4  # of workers at the same job, until the job counts as the cause
_AHEAD = 2  # chunks that a worker has, so that it does not wait for the next one
_END_WITHIN = 0.5  # s for the current run of a worker
_NOT_STARTED = f"a worker process ended as it started; {GO_ON}"
_LIBRARIES = ("pinocchio", "llvmlite.binding")  # imported on first use
_OF_RUNS = tuple(f"runner.{part}." for part in ("config", "controllers", "plants", "store", "symbolic", "trajectories"))
# The next batch of runs reuses freed memory. Otherwise the system would clear 250 KB of fresh pages for each run.
_MEMORY = {"MALLOC_TRIM_THRESHOLD_": str(2**28), "MALLOC_MMAP_THRESHOLD_": str(2**25)}  # bytes


class _Worker:
    """A worker process.

    Args:
        pipe: Pipe to it.

    Attributes:
        pid: Its process ID; 0 until it has started.
        chunks: Its chunks, the current one first.
    """

    def __init__(self, pipe: "Connection[Chunk | None, object]") -> None:
        self.pipe, self.pid = pipe, 0
        self.chunks: deque[Chunk] = deque()

    def send(self, chunk: Chunk | None) -> None:
        """Send a chunk, or None for the end; that a process has died, its pipe shows when it is read."""
        if chunk is not None:
            self.chunks.append(chunk)
        with contextlib.suppress(OSError):
            self.pipe.send(chunk)


class Processes:
    """Worker processes, forked by a first process that has imported the code.

    Args:
        scratch: Folder for the temporary files of their jobs.

    Attributes:
        workers: The workers.
    """

    def __init__(self, scratch: Path) -> None:
        self.workers: list[_Worker] = []
        self._control, theirs = socket.socketpair()
        with theirs:
            self._first = _start(theirs.fileno(), scratch)

    def add(self) -> None:
        """Start another worker.

        Raises:
            TemporaryError: if the first process has ended.
        """
        self.workers.append(self._fork())

    def replace(self, worker: _Worker) -> None:
        """Start another worker instead of one that has died; it receives the chunks that wait.

        Raises:
            TemporaryError: if the worker died before it could work, or the first process has ended.
        """
        if not worker.pid:
            raise TemporaryError(_NOT_STARTED)
        worker.pipe.close()
        new = self._fork()
        for chunk in worker.chunks:
            new.send(chunk)
        self.workers[self.workers.index(worker)] = new

    def end(self) -> None:
        """End the workers: each after its current run, or after a short time."""
        self._control.close()
        for worker in self.workers:
            worker.send(None)
        try:
            self._first.wait(_END_WITHIN)
        except subprocess.TimeoutExpired:
            for pid in filter(None, [worker.pid for worker in self.workers]):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            self._first.kill()
            self._first.wait()
        for worker in self.workers:
            worker.pipe.close()

    def _fork(self) -> _Worker:
        ours, theirs = Pipe()
        with theirs:
            try:
                socket.send_fds(self._control, [b"+"], [theirs.fileno()])
            except BrokenPipeError:
                ours.close()
                raise TemporaryError(_NOT_STARTED) from None
        return _Worker(ours)


def _start(control: int, scratch: Path) -> "subprocess.Popen[bytes]":
    """Start the first process; see fork_workers. It does not import the user's program, which may have no guard."""
    modules = [name for name in sys.modules if name in _LIBRARIES or name.startswith(_OF_RUNS)]
    path = f"import sys; sys.path[:] = {sys.path!r}"
    code = f"{path}; from runner.sweeps.forked import fork_workers; fork_workers({control}, {modules!r})"
    environment = {**os.environ, **_MEMORY, "TMPDIR": str(scratch)}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # Ctrl-C would interrupt its imports
    try:
        return subprocess.Popen(
            [sys.executable, "-c", code], env=environment, stdin=subprocess.DEVNULL, pass_fds=[control]
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def local_processes(count: int, scratch: Path) -> Iterator[Processes]:
    """Start worker processes on this machine, and end them with the context.

    Args:
        count: Number of processes.
        scratch: Folder for all temporary files of their jobs; it is removed at the end.

    Raises:
        RunnerError: if the processes cannot be started.
    """
    scratch.mkdir(parents=True, exist_ok=True)
    try:
        try:
            processes = Processes(scratch)
        except OSError as error:
            raise RunnerError(
                f"the worker processes cannot be started: {str(error).rstrip('.')}; check the limits of open files "
                "and processes (`ulimit -a`), or set hydra.sweeper.workers=0, which needs no worker processes"
            ) from error
        try:
            for _ in range(count):
                processes.add()
            yield processes
        finally:
            processes.end()
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def on_processes(queue: Queue, processes: Processes) -> Generator[ChunkResult]:
    """Process a queue on worker processes; yield the report of each chunk.

    If a worker dies, the unfinished jobs of its current chunk are executed separately, at the end. A job at which
    several workers die is the cause.

    Raises:
        TemporaryError: if a worker dies before it can work.
    """
    deaths: Counter[str] = Counter()

    def fill() -> bool:
        for ahead in range(_AHEAD):
            for worker in processes.workers:
                if len(worker.chunks) == ahead and (chunk := _next(queue, len(processes.workers))) is not None:
                    worker.send(chunk)
        return any(worker.chunks for worker in processes.workers)

    def lost(worker: _Worker) -> ChunkResult | None:
        chunk = worker.chunks.popleft() if worker.chunks else None
        processes.replace(worker)
        if chunk is None:
            return None
        queue.end(chunk)
        deaths.update(chunk.names[:1] if len(chunk.names) == 1 else [])
        if (times := deaths[chunk.names[0]]) >= _DEATHS:
            return give_up(chunk, times)
        return ChunkResult(queue.give_back(chunk), "", 0.0)

    while fill():
        ready = wait([worker.pipe for worker in processes.workers])
        for worker in [worker for worker in processes.workers if worker.pipe in ready]:
            try:
                report = _report(worker, worker.pipe.recv(), queue)
            except (EOFError, OSError):
                report = lost(worker)
            if report is not None:
                queue.learn(report)
                yield report


def _report(worker: _Worker, message: object, queue: Queue) -> ChunkResult | None:
    """Return the report of the current chunk if a message from its worker is one."""
    if isinstance(message, ChunkResult):
        queue.end(worker.chunks.popleft())
        return message
    if isinstance(message, int):
        worker.pid = message
    elif isinstance(message, tuple):
        queue.tell(*message)
    else:
        raise RuntimeError(f"a worker process failed:\n{message}")
    return None


def _next(queue: Queue, workers: int) -> Chunk | None:
    chunk = queue.take(workers)
    return queue.take_suspect() if chunk is None else chunk
