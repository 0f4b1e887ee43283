"""No test depends on the machine: each rule of support.habits_of_tests on examples, and all rules on all tests."""

from pathlib import Path
from textwrap import dedent

import pytest
from support.habits_of_tests import offences

TESTS = Path(__file__).resolve().parents[2]

SLEEP = "sleep"  # written apart, so that this file is looked through as all others are
BAD = {
    f"time.{SLEEP}(0.1)": "sleeps",
    "await asyncio.sleep(1)": "sleeps",
    f"from time import {SLEEP}": "sleeps",
    f"PLUG_IN = 'import time\\ntime.{SLEEP}(60)'": "sleeps",
    f"PLUG_IN = 'from time import {SLEEP}'": "sleeps",
    "process.wait()": "wait without a limit",
    "thread.join()": "join without a limit",
    "process.communicate()": "communicate without a limit",
    "process.communicate(b'text')": "communicate without a limit",
    "done.wait(10.0)": "a limit in seconds",
    "thread.join(timeout=5)": "a limit in seconds",
    "subprocess.run(command, timeout=60)": "a limit in seconds",
    "select(readers, timeout=1.0)": "a limit in seconds",
    "while True: pass": "a loop without a limit",
    "while 1: pass": "a loop without a limit",
    "while not path.exists(): pass": "a loop without a limit",
    "while (chunk := queue.take(1)) is not None: pass": "a loop without a limit",
    "while 'left' not in text and select(readers): pass": "a loop without a limit",
    "server.bind(('127.0.0.1', 0))": "a chosen port",
    "start(['scheduler', '--port', '8786'])": "a chosen port",
    "start('scheduler', '--port', str(port))": "a chosen port",
    "assert time.monotonic() < end": "compares what a clock gave",
    "assert perf_counter() - start < 5.0": "compares what a clock gave",
    "late = time.time() > end": "compares what a clock gave",
    "def test():\n    took = time.perf_counter() - start\n    assert took < 1.0": "compares what a clock gave",
    "def test():\n    end = time.monotonic_ns() + 5\n    if end > limit:\n        pass": "compares what a clock gave",
}
GOOD = [
    "process.wait(PATIENCE)",
    "thread.join(timeout=PATIENCE)",
    "subprocess.run(command)",
    "subprocess.run(command, timeout=PATIENCE)",
    "', '.join(names)",
    "stored.join(other)",
    "while frontier: frontier.pop()",
    "while len(found) < count: found.append(draw())",
    "for _ in range(100): look()",
    "start('scheduler', '--port', '0')",
    "start(['--port'])",
    "began = time.perf_counter()",
    "cost = time.perf_counter() - began",
    "assert trace.time() < 1.0",
    "def one():\n    end = time.time()\ndef two(end):\n    assert end < 1.0",
    "assert 'sleep' in text",
]


@pytest.mark.parametrize(("code", "rule"), BAD.items(), ids=list(BAD))
def test_each_rule_finds_its_example(code, rule):
    code = f"async def test():\n    {code}" if code.startswith("await") else code
    found = offences(code)
    assert [offence.rule.partition(";")[0] for offence in found] == [rule]


@pytest.mark.parametrize("code", GOOD, ids=GOOD)
def test_what_depends_on_no_machine_is_left_alone(code):
    assert offences(code) == []


def test_the_line_is_named():
    code = "first = 1\n\n\ndef test():\n    done.wait()\n"
    assert [offence.line for offence in offences(dedent(code))] == [5]


@pytest.mark.costs(3)
def test_no_test_depends_on_the_machine():
    found = [
        f"{path.relative_to(TESTS.parent)}:{offence.line}: {offence.rule}"
        for path in sorted(TESTS.rglob("*.py"))
        for offence in offences(path.read_text(encoding="utf-8"))
    ]
    assert found == []
