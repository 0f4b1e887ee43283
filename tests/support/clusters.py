"""A Dask cluster as a user starts it: a scheduler and workers, each a process of its own."""

import json
import subprocess
import sys
from pathlib import Path

from support.patience import PATIENCE, wait_until

Process = subprocess.Popen[bytes]


class Cluster:
    """A scheduler on a port of its own choice, and workers of one thread.

    Args:
        folder: Where its processes run; it must exist.

    Attributes:
        address: Address of the scheduler.
        scheduler: Its process.
        workers: Their processes.
    """

    def __init__(self, folder: Path, workers: int) -> None:
        self._folder, file = folder, folder / "scheduler.json"
        self._where = ("--scheduler-file", str(file), "--no-dashboard")
        self.workers: list[Process] = []
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", "0")
        for _ in range(workers):  # they wait for the file
            self.add_worker()
        wait_until(lambda: file.exists() and file.read_text().endswith("}"))
        self.address = str(json.loads(file.read_text())["address"])

    def add_worker(self) -> Process:
        """Start one more worker; return its process."""
        self.workers.append(self._start("worker", "--nthreads", "1", "--no-nanny"))
        return self.workers[-1]

    def close(self) -> None:
        """End all processes."""
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait(PATIENCE)

    def _start(self, *words: str) -> Process:
        command = [sys.executable, "-m", "dask", *words, *self._where]
        return subprocess.Popen(command, cwd=self._folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
