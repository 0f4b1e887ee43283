"""What the tests cost: the ten slowest, and the CPU time of all processes, before pytest's closing line."""

import os
import resource
import time
from collections.abc import Iterator

import pytest

_SLOWEST = 10
_began: dict[str, tuple[float, float]] = {}


def cpu_time() -> float:
    """Return the CPU time of this process and of those that it started and that have ended, in s."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Note when a test begins; the fixtures that it is the first to ask for count as its own."""
    _began[item.nodeid] = time.perf_counter(), cpu_time()
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[pytest.TestReport]:
    """Let the last report of a test tell what it took, from whichever process it comes."""
    report = yield
    if call.when == "teardown":
        began, used = _began.pop(item.nodeid)
        report.user_properties.append(("cost", (time.perf_counter() - began, cpu_time() - used)))
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the slowest tests, and what all took; the processes of the tests have ended by now."""
    costs = [
        (*dict(report.user_properties)["cost"], report.nodeid)
        for reports in terminalreporter.stats.values()
        for report in reports
        if "cost" in dict(getattr(report, "user_properties", ()))
    ]
    if not costs:
        return
    slowest = sorted(costs, reverse=True)[:_SLOWEST]
    terminalreporter.section(f"slowest {len(slowest)} tests")
    for wall, cpu, test in slowest:
        terminalreporter.line(f"{wall:7.2f} s, CPU {cpu:7.2f} s  {test}")
    terminalreporter.line(f"CPU time of all processes: {cpu_time():.0f} s on {os.cpu_count()} cores")
