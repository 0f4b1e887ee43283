"""Runs tests in forks of a process that has imported every library, and nothing of the tree.

Reads a request a line from standard input and answers each by a line on standard output; `Request` has the keys.
"""

import importlib
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

_LIBRARIES = (
    *("numpy", "scipy.linalg", "scipy.optimize", "scipy.signal", "scipy.stats", "pandas", "pyarrow.parquet"),
    *("pinocchio", "pybullet", "mujoco", "llvmlite.binding", "hydra", "omegaconf", "pydantic", "yaml", "typst"),
    *("matplotlib.pyplot", "matplotlib.backends.backend_agg", "plotly.graph_objects", "jinja2", "markdown_it"),
    *("optuna", "distributed", "dask", "hypothesis", "_hypothesis_pytestplugin", "xdist.plugin"),
)
_STARTS_AGAIN = "jemalloc_bg_thd"  # Arrow's memory: its library makes a new one in a fork


class Selection:
    """Plug-in of pytest: takes the tests of a request in its order, ends at a limit of CPU time, and notes failures."""

    def __init__(self, request: dict[str, Any]) -> None:
        self._request = request
        self.ran, self.failed, self.stopped = 0, "", False

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        """Take the tests asked for, and before them those of whole files, except for those that are left out."""
        place = {test: index for index, test in enumerate(self._request["tests"])}
        left_out, whole = set(self._request["left_out"]), set(self._request["whole"])
        ranked = []
        for item in items:
            test = f"{item.path.name}::{item.nodeid.partition('::')[2]}"
            if test in place:
                ranked.append((place[test], item))
            elif item.path.name in whole and test not in left_out:
                ranked.append((-1, item))
        items[:] = [item for _, item in sorted(ranked, key=lambda pair: pair[0])]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[Any]:
        """Count tests, and end at the limit."""
        result = yield
        self.ran += 1
        if _cpu_time() > self._request["limit"]:
            self.stopped = True
            item.session.shouldstop = "the limit of CPU time"
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note the first test that fails."""
        if report.failed and not self.failed:
            path, _, name = report.nodeid.partition("::")
            self.failed = f"{path.rpartition('/')[2]}::{name}"


def main() -> None:
    """Serve until standard input ends."""
    for name in _LIBRARIES:
        with suppress(ImportError):
            importlib.import_module(name)
    names = [(task / "comm").read_text().strip() for task in Path("/proc/self/task").iterdir()]
    answers = os.fdopen(os.dup(1), "w")
    print(json.dumps({"threads": [name for name in names[1:] if name != _STARTS_AGAIN]}), file=answers, flush=True)
    for line in sys.stdin:
        print(json.dumps(_serve(json.loads(line))), file=answers, flush=True)


def _serve(request: dict[str, Any]) -> dict[str, Any]:
    """Run the tests of a request in a separate group of processes, which ends with them."""
    result = Path(request["result"])
    result.unlink(missing_ok=True)
    child = os.fork()
    if child == 0:
        _run(request, result)
    began, used = time.monotonic(), None
    while used is None:
        pid, status, usage = os.wait4(child, os.WNOHANG)
        if pid:
            used = usage.ru_utime + usage.ru_stime
        elif time.monotonic() - began > request["wall"]:
            os.killpg(child, signal.SIGKILL)
        time.sleep(0.02)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)
    if result.is_file():
        return {**json.loads(result.read_text()), "cpu": used}
    return {"signal": os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0, "cpu": used, "failed": "", "ran": 0}


def _run(request: dict[str, Any], result: Path) -> None:
    os.setsid()
    log = os.open(request["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.environ.update(request["environment"])
    limit = int(request["hard"])
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    selection, code = Selection(request), 3
    try:
        options = ["-x", "-q", "-n", "0", "-p", "no:cacheprovider", "-W", "ignore::pytest.PytestAssertRewriteWarning"]
        code = int(pytest.main([*options, "--basetemp", request["temporary"], *request["files"]], plugins=[selection]))
    except BaseException as error:  # whatever a mutant does to pytest itself
        print(repr(error), file=sys.stderr)
    told = {"code": code, "failed": selection.failed, "ran": selection.ran, "stopped": selection.stopped}
    result.write_text(json.dumps(told))
    sys.stdout.flush()
    os._exit(0)


def _cpu_time() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


if __name__ == "__main__":
    main()
