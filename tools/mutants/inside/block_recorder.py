"""Plug-in of pytest: writes which blocks each test runs, which files it reads, and the CPU time it takes.

What a fixture of a wider scope runs and reads counts for each test that uses it, and so does the file of each fixture.
"""

import functools
import json
import os
import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

_FOLDER = Path(os.environ["BLOCKS_FOLDER"])
_WORKER = os.environ.get("PYTEST_XDIST_WORKER", "main")
os.environ["BLOCKS_HITS"] = str(_FOLDER / f"hits-{_WORKER}")
Path(os.environ["BLOCKS_HITS"]).write_bytes(bytes(int(os.environ["BLOCKS_COUNT"])))

import block_probes  # noqa: E402 - opens the file

functools.lru_cache = block_probes.lru_cache
_files: dict[str, int] = json.loads(Path(os.environ["BLOCKS_TABLE"]).read_text())["files"]
_made: dict[int, bytes] = {}
_used: dict[int, Any] = {}
_failed: list[str] = []


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: Any) -> Iterator[Any]:
    """Keep what a fixture runs that several tests share."""
    if fixturedef.scope == "function":
        return (yield)
    before = block_probes.taken()
    try:
        return (yield)
    finally:
        _made[id(fixturedef)] = block_probes.hits[:]
        block_probes.add(before)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: Any) -> Iterator[None]:
    """Note the shared fixtures of a test, those included that it asks for as it runs."""
    try:
        return (yield)
    finally:
        _used.update((id(made), made) for made in item._request._fixture_defs.values())


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[Any]:
    """Write what a test has run."""
    block_probes.taken()
    _used.clear()
    _failed.clear()
    began = _cpu_time()
    result = yield
    cost = _cpu_time() - began
    for name, made in _used.items():
        block_probes.add(_made.get(name, b""))
        file = _files.get(getattr(getattr(made.func, "__code__", None), "co_filename", ""))
        if file is not None:
            block_probes.hits[file] = 1
    seen = block_probes.taken()
    line = {"test": item.nodeid, "cpu": round(cost, 4), "passed": not _failed, "blocks": _indices(seen)}
    with (_FOLDER / f"tests-{_WORKER}.jsonl").open("a") as file:
        file.write(json.dumps(line, separators=(",", ":")) + "\n")
    return result


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Note failures and skips: such a test finds nothing."""
    if report.outcome != "passed":
        _failed.append(report.nodeid)


def _indices(seen: bytes) -> list[int]:
    return [index for index, byte in enumerate(seen) if byte]


def _cpu_time() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)
