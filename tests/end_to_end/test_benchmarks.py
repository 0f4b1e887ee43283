"""Benchmarks as processes: each prints its table without a traceback, in one brief round."""

import subprocess
import sys

import pytest

from bench.__main__ import NAMES, missed_rows
from bench.least_loops import MissingError, least_loop
from runner.base.paths import package_dir

pytestmark = pytest.mark.slow


def run(*words):
    root = package_dir().parent
    return subprocess.run([sys.executable, "-m", *words], cwd=root, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("name", NAMES)
def test_a_benchmark_prints_its_table(name):
    ending = run("bench", name, "--rounds", "1")
    assert "Traceback" not in ending.stderr
    if f"{name}: left out because" in ending.stdout:
        return
    rows = missed_rows(ending.stdout.rpartition("\n\n")[0])
    assert ending.returncode == bool(rows)
    assert "target" in ending.stdout or "at most" in ending.stdout
    assert f"{len(rows)} missed" in ending.stdout if rows else ending.stdout.endswith("\nall targets are met\n")


def test_without_a_compiler_the_table_says_what_it_lacks(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda *_: None)
    with pytest.raises(MissingError, match=r"there is no g\+\+"):
        least_loop(None)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("none",), "NAME: unknown benchmark (none). Allowed: tick, laws, "),
        (("tick", "--rounds", "0"), "--rounds: too few (0). Allowed: 1 or more."),
    ],
)
def test_wrong_words_are_refused(words, expected):
    ending = run("bench", *words)
    assert (ending.returncode, ending.stdout) == (2, "")
    assert expected in ending.stderr
