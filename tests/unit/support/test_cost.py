"""What the tests cost is told before pytest's closing line."""

import subprocess
import sys
from types import SimpleNamespace

from fixtures import cost


class Terminal:
    """In place of pytest's: keeps what is written."""

    def __init__(self, reports):
        self.stats = {"": reports, "passed": [SimpleNamespace(nodeid="a call", user_properties=[])]}
        self.lines = []

    def section(self, title):
        self.lines.append(f"== {title} ==")

    def line(self, text):
        self.lines.append(text)


def report(name, wall, cpu):
    return SimpleNamespace(nodeid=name, user_properties=[("cost", (wall, cpu))])


def test_the_ten_slowest_are_told_and_the_total_last():
    terminal = Terminal([report(f"test {number}", float(number), 0.5) for number in range(25)])
    cost.pytest_terminal_summary(terminal)
    assert terminal.lines[0] == "== slowest 10 tests =="
    assert terminal.lines[1] == "  24.00 s, CPU    0.50 s  test 24"
    assert [line.rpartition("  ")[2] for line in terminal.lines[1:-1]] == [
        f"test {number}" for number in range(24, 14, -1)
    ]
    assert terminal.lines[-1].startswith("CPU time of all processes: ")


def test_without_tests_nothing_is_told():
    terminal = Terminal([])
    cost.pytest_terminal_summary(terminal)
    assert terminal.lines == []


def test_processes_that_ended_count():
    script = "import time; sum(range(3_000_000)); print(time.process_time())"
    before = cost.cpu_time()
    told = subprocess.run([sys.executable, "-S", "-c", script], capture_output=True, text=True, check=True).stdout
    assert cost.cpu_time() - before > 0.9 * float(told)


def test_a_test_of_this_session_has_its_cost(request):
    assert request.config.pluginmanager.has_plugin("cost")
    assert request.node.nodeid in cost._began
