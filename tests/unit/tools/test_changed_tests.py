"""Tests that a change can affect, chosen by a map of six tests of a small tree."""

import subprocess

import numpy as np
import pytest

from tools import changed_tests
from tools.changed_tests import AT_IMPORT, DOCSTRINGS, changed_owners, changes, choose, report
from tools.mutants.choosing import CoverageMap
from tools.mutants.recording import key

LAW = '''"""A law."""

GAIN = 2.0


class Law:
    """Its torques."""

    damping = 1.0

    def torque(self, error):
        """Return the torque."""
        return GAIN * error

    def energy(self, speed):
        return speed**2
'''
USER = "from package.law import Law\n\n\ndef move(law):\n    return law.torque(1.0)\n\n\ndef rest():\n    return 0.0\n"
PAGE = "def describe(law):\n    return type(law).__doc__\n"
LAW_PY, USER_PY, PAGE_PY, CONF = "package/law.py", "package/user.py", "package/page.py", "conf/law/law.yaml"

BLOCKS = {
    "torque": (LAW_PY, "Law.torque"),
    "energy": (LAW_PY, "Law.energy"),
    "move": (USER_PY, "move"),
    "rest": (USER_PY, "rest"),
    "describe": (PAGE_PY, "describe"),
}
FILES = (CONF, "conf/law/other.yaml", LAW_PY, "docs/page.md")
RUNS = {
    "torque": (["torque"], []),
    "energy": (["energy"], []),
    "move": (["move", "torque"], [CONF]),
    "rest": (["rest"], ["conf/law/other.yaml"]),
    "describe": (["describe"], []),
    "text": ([], [LAW_PY, "docs/page.md"]),
}
TESTS = [f"test_{name}.py::test_it" for name in RUNS]


@pytest.fixture
def known():
    ran = np.array([[block in run for block in BLOCKS] for run, _ in RUNS.values()])
    read = np.array([[file in files for file in FILES] for _, files in RUNS.values()])
    blocks = tuple(key(path, owner, 0) for path, owner in BLOCKS.values())
    return CoverageMap(blocks, tuple(TESTS), np.arange(6.0), ran, FILES, read)


@pytest.fixture
def tree(tmp_path):
    for path, text in {LAW_PY: LAW, USER_PY: USER, PAGE_PY: PAGE, CONF: "kind: law\n"}.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


def names(chosen):
    return sorted(test.removeprefix("test_").partition(".")[0] for test in chosen)


@pytest.mark.parametrize(
    ("old", "new", "chosen"),
    [
        ("GAIN * error", "GAIN + error", ["move", "text", "torque"]),
        ("speed**2", "speed**3", ["energy", "text"]),
        ('"""Return the torque."""', '"""Return it."""', ["text"]),
        ("# a remark", "# another", ["text"]),
        ('"""Its torques."""', '"""Torques."""', ["describe", "text"]),
        ("GAIN = 2.0", "GAIN = 3.0", ["energy", "move", "rest", "text", "torque"]),  # rest's module imports it
        ("damping = 1.0", "damping = 2.0", ["energy", "move", "rest", "text", "torque"]),
        ("self, speed", "self, speed=1.0", ["energy", "move", "rest", "text", "torque"]),
        ("def energy", "def torque_too", ["energy", "move", "rest", "text", "torque"]),
    ],
)
def test_a_change_chooses_what_runs_or_reads_it(known, tree, old, new, chosen):
    before = LAW + "# a remark\n"
    assert before.count(old) == 1
    assert names(choose(known, {LAW_PY: (before, before.replace(old, new))}, tree)) == chosen


def test_a_file_of_data_chooses_its_readers_and_a_new_one_those_of_its_folder(known, tree):
    assert names(choose(known, {CONF: ("kind: law\n", "kind: law\ngain: 1\n")}, tree)) == ["move"]
    assert names(choose(known, {"conf/law/new.yaml": ("", "kind: law\n")}, tree)) == ["move", "rest"]
    assert choose(known, {"README.md": ("a", "b")}, tree) == set()


def test_a_constant_chooses_the_test_files_that_import_it(known, tree):
    (tree / "tests").mkdir()
    (tree / "tests" / "test_describe.py").write_text("from package.law import GAIN\n")
    changed = {LAW_PY: (LAW, LAW.replace("GAIN = 2.0", "GAIN = 3.0"))}
    assert "describe" in names(choose(known, changed, tree))


def test_owners_of_what_cannot_be_parsed_and_of_nothing():
    assert changed_owners(LAW, LAW) == set()
    assert AT_IMPORT in changed_owners(LAW, LAW + "def (")
    assert changed_owners(LAW, LAW.replace("A law.", "The law.")) == {DOCSTRINGS}


def test_what_is_left_out_is_said(known):
    changed, chosen = {LAW_PY: 0, "pyproject.toml": 0}, {TESTS[1], TESTS[2]}
    first, left, unknown, all_tests = report(known, changed, chosen, {"test_x.py"}, ["test_new.py"])
    assert first == "2 changed files: 2 of 6 tests, 3 of 15 s of CPU time, and all of 1 changed test files"
    assert unknown == "left out: 1 test files that are not in the map, test_new.py ...: make coverage-map"
    assert left.startswith("left out: 4 tests that run no changed function")
    assert all_tests.endswith("what pyproject.toml can affect, which is all tests: make test")


def test_changes_are_those_since_a_commit_and_new_files(tree):
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "first"]):
        subprocess.run([*git, *words], cwd=tree, check=True)
    (tree / USER_PY).write_text("changed\n")
    (tree / PAGE_PY).unlink()
    (tree / "new.py").write_text("new\n")
    assert changes("HEAD", tree) == {USER_PY: (USER, "changed\n"), PAGE_PY: (PAGE, ""), "new.py": ("", "new\n")}


def test_without_a_map_one_line_says_so(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(changed_tests, "ROOT", tmp_path)
    assert changed_tests.main([]) == 2
    assert capsys.readouterr().out.splitlines() == [
        "make test-changed: no .cache/coverage_map.npz, the tests that run each line; `make coverage-map` records it"
    ]
