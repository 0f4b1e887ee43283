"""A Dask cluster as a user starts it: a scheduler and workers, each its own process."""

import json
import subprocess
import sys
from pathlib import Path

from distributed import Client
from support.patience import PATIENCE, wait_until

Process = subprocess.Popen[bytes]


class Cluster:
    """A scheduler on its own port choice, and workers of one thread.

    Args:
        folder: Where its processes run; it must exist.

    Attributes:
        address: Address of the scheduler.
        scheduler: Its process.
        workers: Their processes.
    """

    def __init__(self, folder: Path, workers: int) -> None:
        self._folder = folder
        file = self.file
        self._where = ("--scheduler-file", str(file), "--no-dashboard")
        self.workers: list[Process] = []
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", "0")
        self._start_workers(workers)  # they wait for the file
        wait_until(lambda: file.exists() and file.read_text().endswith("}"))
        self.address = str(json.loads(file.read_text())["address"])
        self._wait_for_workers()

    @property
    def file(self) -> Path:
        """The scheduler file."""
        return self._folder / "scheduler.json"

    def add_worker(self, *options: str) -> Process:
        """Start one more worker, with options of `dask worker`; return its process."""
        self._start_workers(1, *options)
        self._wait_for_workers()
        return self.workers[-1]

    def end(self, worker: Process) -> None:
        """Kill a worker."""
        self.workers.remove(worker)
        worker.kill()
        worker.wait(PATIENCE)

    def close(self) -> None:
        """End all processes."""
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait(PATIENCE)

    def _start_workers(self, count: int, *options: str) -> None:
        self.workers += [self._start("worker", "--nthreads", "1", "--no-nanny", *options) for _ in range(count)]

    def _wait_for_workers(self) -> None:
        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(len(self.workers), timeout=PATIENCE)

    def _start(self, *words: str) -> Process:
        command = [sys.executable, "-m", "dask", *words, *self._where]
        return subprocess.Popen(command, cwd=self._folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
