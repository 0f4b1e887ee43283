"""Puts mutants one at a time into copies of a checkout and runs the tests that may find them, in forks."""

import json
import os
import queue
import shutil
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tools.mutants.choosing import Choice
from tools.mutants.mutant import Mutant
from tools.mutants.results import KILLED, NOT_COVERED, SURVIVED, TIMEOUT
from tools.mutants.trees import copy_tree, environment, python

_HARD = 3.0  # times what the tests took when the map was recorded: an endless loop has run longer
_START = 60.0  # CPU time of imports, collection and fixtures [s]
_WALL = 900.0  # waiting for something that a mutant keeps from coming ends here [s]
_PASSED, _FAILED, _NOTHING_RAN = 0, 1, 5  # exit codes of pytest


class Worker:
    """A copy of a checkout and the server of forks that runs its tests.

    Args:
        tree: The checkout, with its own `.venv`.
        scratch: A folder that is used once.
        limit: CPU time after which no further test begins [s].
        left_out: Short names of tests that run only where a choice names them.
    """

    def __init__(self, tree: Path, scratch: Path, limit: float, left_out: Iterable[str]) -> None:
        self._copy, self._scratch, self._limit, self._left_out = scratch / "tree", scratch, limit, list(left_out)
        copy_tree(tree, self._copy)
        self._writes = int(time.time())
        self._server = subprocess.Popen(
            [python(tree), "-m", "fork_server"],
            cwd=self._copy,
            env=environment(self._copy, scratch, {"PYTHONDONTWRITEBYTECODE": "1"}),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        threads = self._answer()["threads"]
        if threads:
            raise RuntimeError(f"a library started {', '.join(threads)}, which forks would lack")

    def close(self) -> None:
        """End the server."""
        assert self._server.stdin is not None
        self._server.stdin.close()
        self._server.wait()

    def try_mutant(self, mutant: Mutant, choice: Choice) -> dict[str, Any]:
        """Return the outcome of a mutant."""
        path = self._copy / mutant.path
        source = path.read_text()
        self._write(path, mutant.apply(source))
        try:
            answer = self.run(choice)
        finally:
            self._write(path, source)
        seen = {"by": answer["failed"], "ran": answer["ran"], "cpu": round(answer["cpu"], 2)}
        code = answer.get("code")
        if code is None:
            return {"status": TIMEOUT, **seen}
        if code == _PASSED or (answer["stopped"] and not answer["failed"]):
            return {"status": SURVIVED, **seen, "limited": answer["stopped"]}
        if code == _NOTHING_RAN:
            return {"status": NOT_COVERED, **seen}
        if code != _FAILED:
            seen["by"] = seen["by"] or self._last_line()
        return {"status": KILLED, **seen}

    def run(self, choice: Choice) -> dict[str, Any]:
        """Run tests on the unchanged copy; return the server's answer."""
        cache, temporary = self._scratch / "cache", self._scratch / "temporary"
        shutil.rmtree(cache, ignore_errors=True)  # code that a law's former source gave
        shutil.rmtree(temporary, ignore_errors=True)
        cache.mkdir(mode=0o700)
        (self._scratch / "matplotlib").mkdir(exist_ok=True)
        request = {
            "files": choice.files,
            "tests": choice.tests,
            "whole": choice.whole,
            "left_out": self._left_out,
            "limit": self._limit,
            "hard": _START + _HARD * min(choice.cost or self._limit, self._limit),
            "wall": _WALL,
            "log": str(self._scratch / "log"),
            "result": str(self._scratch / "result.json"),
            "temporary": str(temporary),
            "environment": {"MPLCONFIGDIR": str(self._scratch / "matplotlib")},
        }
        assert self._server.stdin is not None
        self._server.stdin.write(json.dumps(request) + "\n")
        self._server.stdin.flush()
        return self._answer()

    def _answer(self) -> dict[str, Any]:
        assert self._server.stdout is not None
        answer: dict[str, Any] = json.loads(self._server.stdout.readline())
        return answer

    def _write(self, path: Path, source: str) -> None:
        """Write a module with a time that no compiled file has."""
        path.write_text(source)
        self._writes += 1
        os.utime(path, (self._writes, self._writes))

    def _last_line(self) -> str:
        lines = (self._scratch / "log").read_text(errors="replace").strip().splitlines()
        return next(
            (line for line in reversed(lines) if line.startswith(("E ", "ERROR", "ImportError"))), "pytest ended early"
        )


def try_all(
    tree: Path,
    work: Iterable[tuple[Mutant, Choice]],
    workers: int,
    limit: float,
    left_out: Iterable[str],
    done: Callable[[Mutant, dict[str, Any]], None],
) -> None:
    """Try mutants by several workers, and print each result."""
    waiting: queue.SimpleQueue[tuple[Mutant, Choice]] = queue.SimpleQueue()
    for pair in work:
        waiting.put(pair)
    lock = threading.Lock()

    def serve() -> None:
        with _working(tree, limit, left_out) as worker:
            while True:
                try:
                    mutant, choice = waiting.get_nowait()
                except queue.Empty:
                    return
                result = worker.try_mutant(mutant, choice)
                with lock:
                    done(mutant, result)

    with ThreadPoolExecutor(workers) as pool:
        for ended in [pool.submit(serve) for _ in range(workers)]:
            ended.result()


def failing(tree: Path, finders: Mapping[str, str], limit: float) -> set[str]:
    """Return those of some tests, given with their files, that fail on the unchanged checkout."""
    found: set[str] = set()
    with _working(tree, limit * (1 + len(finders)), ()) as worker:
        while left := {test: file for test, file in finders.items() if test not in found}:
            answer = worker.run(Choice(tuple(dict.fromkeys(left.values())), tuple(left)))
            if not answer["failed"]:
                break
            found.add(answer["failed"])
    return found


@contextmanager
def _working(tree: Path, limit: float, left_out: Iterable[str]) -> Iterator[Worker]:
    with tempfile.TemporaryDirectory(prefix="mutants-", ignore_cleanup_errors=True) as folder:
        worker = Worker(tree, Path(folder).resolve(), limit, left_out)
        try:
            yield worker
        finally:
            worker.close()
