"""Costs of tests: what the summary prints and what fails a session, against costs made by hand."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from fixtures import cost
from fixtures.cost import Cost

TESTS = Path(__file__).resolve().parents[2]


class Terminal:
    """Substitute for pytest's reporter: it keeps the written lines."""

    def __init__(self, reports):
        self.stats = {"": reports, "passed": [SimpleNamespace(nodeid="a call", user_properties=[])]}
        self.lines = []

    def section(self, title):
        self.lines.append(f"== {title} ==")

    def line(self, text):
        self.lines.append(text)


def report(name, cpu, shared=0.0, yardsticks=()):
    measured = [("yardstick", yardstick) for yardstick in yardsticks]
    return SimpleNamespace(nodeid=name, user_properties=[("cost", (0.5, cpu, shared, 1.0)), *measured])


@pytest.fixture
def config():
    return SimpleNamespace(stash=pytest.Stash())


def test_the_ten_dearest_are_printed_and_the_total_last(config):
    terminal = Terminal([report(f"tests/unit/store/test_a.py::test {number}", float(number)) for number in range(25)])
    cost.pytest_terminal_summary(terminal, config)
    assert terminal.lines[0] == "== dearest 10 tests =="
    assert terminal.lines[1] == "   0.50 s, CPU   24.00 s  tests/unit/store/test_a.py::test 24"
    assert [line.rpartition(" ")[2] for line in terminal.lines[1:11]] == [str(number) for number in range(24, 14, -1)]
    assert terminal.lines[-1].startswith("CPU time of all processes: ")


def test_cpu_time_is_printed_by_folder(config):
    nodes = ("tests/unit/store/test_a.py::t[a/b]", "tests/config/test_b.py::t", "tests/test_c.py::t")
    terminal = Terminal([report(node, 2.0, shared=1.0) for node in nodes] + [report(nodes[1], 3.0)])
    cost.pytest_terminal_summary(terminal, config)
    assert terminal.lines[-2] == "CPU time in s: config 5, unit/store 2, tests 2, session fixtures 3"


def test_the_yardstick_is_the_mean_of_what_the_processes_measured(config, monkeypatch, tmp_path):
    monkeypatch.setattr(cost, "BUDGETS", tmp_path / "budgets.yaml")
    cost.BUDGETS.write_text("unit/base: 6")
    given = {"a": (), "b": (1.5,), "c": (2.0,), "d": (2.5,)}
    reports = [report(f"tests/unit/base/test_a.py::{name}", 5.0, 0.0, measured) for name, measured in given.items()]
    terminal = Terminal(reports)
    cost.pytest_terminal_summary(terminal, config)
    assert terminal.lines[-3] == "all: 10.0 yardsticks, more than 1.5 times the budgets of 6"
    assert terminal.lines[-2].endswith(" yardsticks of 2.00 s (1.50 to 2.50 s, 3 times)")


def test_the_yardstick_is_timed_first_and_then_after_each_minute_of_cpu_time(monkeypatch):
    used = iter([0.0, 1.0, 59.9, 60.0, 61.5])
    monkeypatch.setattr(cost, "_CLOCK", cost._Clock())
    monkeypatch.setattr(cost, "measure_yardstick", lambda: 2.0)
    monkeypatch.setattr(cost, "cpu_time", lambda: next(used))
    assert [cost._measured_when_due() for _ in range(4)] == [[2.0], [], [], [2.0]]


def test_without_tests_nothing_is_printed(config):
    terminal = Terminal([])
    cost.pytest_terminal_summary(terminal, config)
    assert terminal.lines == []


@pytest.mark.parametrize(("cpu", "dear"), [(7.9, False), (8.0, False), (8.1, True)])
def test_a_test_is_too_dear_above_four_times_what_it_states(cpu, dear):
    lines = cost.too_dear([Cost("a", 0.0, cpu, 100.0, 4.0)], yardstick=0.5)
    assert lines == (["a: 16.2 yardsticks, more than 4 times the stated 4"] if dear else [])


def spent(**seconds):
    return [Cost(f"tests/unit/{folder}/test_a.py::a", 0.0, cpu, 100.0, 4.0) for folder, cpu in seconds.items()]


def test_a_folder_is_too_dear_above_its_share_of_all_and_a_new_one_needs_a_budget():
    budgets = {"unit/store": 8.0, "unit/base": 8.0}
    assert cost.over_budget(spent(store=5.0, base=3.0), budgets, yardstick=0.5) == []  # 10 of 8
    assert cost.over_budget(spent(store=5.1, base=2.9), budgets, yardstick=0.5) == [
        "unit/store: 10.2 yardsticks, more than 1.25 times its share of all, 8.0"
    ]
    assert cost.over_budget(spent(store=2.6, base=1.4), budgets, yardstick=0.5) == [  # on a machine twice as fast
        "unit/store: 5.2 yardsticks, more than 1.25 times its share of all, 4.0"
    ]
    assert cost.over_budget(spent(store=5.0), {}, yardstick=0.5) == [
        "unit/store: 10.0 yardsticks; budgets.yaml has no budget for it"
    ]


def test_all_folders_together_are_too_dear_above_half_as_much_again():
    budgets = {"unit/store": 8.0, "unit/base": 8.0, "unit/cli": 5.0}
    assert cost.over_budget(spent(store=6.0, base=6.0), budgets, yardstick=0.5) == []
    assert cost.over_budget(spent(store=6.1, base=6.0), budgets, yardstick=0.5) == [
        "all: 24.2 yardsticks, more than 1.5 times the budgets of 16"
    ]


def test_each_folder_of_tests_has_a_budget():
    files = [path.relative_to(TESTS.parent) for path in TESTS.rglob("test_*.py")]
    folders = {cost.folder_of(f"{path.as_posix()}::test") for path in files}
    assert set(yaml.safe_load(cost.BUDGETS.read_text())) == folders


def test_processes_that_ended_count():
    script = "import time; sum(range(3_000_000)); print(time.process_time())"
    before = cost.cpu_time()
    stated = subprocess.run([sys.executable, "-S", "-c", script], capture_output=True, text=True, check=True).stdout
    assert cost.cpu_time() - before > 0.9 * float(stated)


def test_a_test_of_this_session_has_its_cost(request):
    assert request.config.pluginmanager.has_plugin("fixtures.cost")


DEAR = """\
import time
import pytest

@pytest.fixture(scope="session")
def dear():
    began = time.process_time()
    total = 0
    for number in range(100_000_000):
        total += number
        if time.process_time() - began > 0.2:
            return

def test_that_asks_for_a_dear_fixture(dear):
    pass

@pytest.mark.costs({states})
def test_that_is_dear():
    began = time.process_time()
    total = 0
    for number in range(100_000_000):
        total += number
        if time.process_time() - began > 0.2:
            return
"""


@pytest.mark.parametrize(("states", "code"), [(0.2, 1), (2.0, 0)])
def test_a_session_fails_if_a_test_is_too_dear(tmp_path, states, code):
    """The yardstick takes 0.1 s here, and the test 0.2 s, as does a fixture of the session, which is not counted."""
    (tmp_path / "conftest.py").write_text("from fixtures import cost\n\ncost.measure_yardstick = lambda: 0.1\n")
    (tmp_path / "test_dear.py").write_text(DEAR.format(states=states))
    command = [sys.executable, "-m", "pytest", "-p", "fixtures.cost", "-p", "no:xdist", "--enforce-costs"]
    given = {**os.environ, "PYTHONPATH": str(TESTS), "PYTEST_ADDOPTS": ""}
    ended = subprocess.run(command, cwd=tmp_path, env=given, capture_output=True, text=True, check=False)
    assert ended.returncode == code, ended.stdout
    assert ("more than 4 times the stated 0.2" in ended.stdout) == (code == 1)
