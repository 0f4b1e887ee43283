"""Tests that a coverage map gives for a mutant: those that run its block, the mirrored file's first, to a limit."""

import numpy as np
import pytest

from tools.mutants import choosing
from tools.mutants.choosing import CoverageMap, short
from tools.mutants.places import places
from tools.mutants.recording import key

SOURCE = """\
LIMIT = 3
SPARE = 4


def low(a):
    if a < LIMIT:
        return a + 1
    return a - 1


def high(a):
    return a * 5
"""
PATH, USER = "runner/plants/m.py", "runner/simulation/user.py"
BLOCKS = [key(PATH, "low", 0), key(PATH, "low", 1), key(PATH, "low", 2), key(PATH, "high", 0), key(USER, "ask", 0)]
TESTS = {  # blocks that it runs, CPU time in s
    "tests/a/test_far.py::test_all": ([0, 1, 2, 3, 4], 1.0),
    "tests/a/test_far.py::test_low": ([0, 1], 2.0),
    "tests/a/test_far.py::test_cheap_low": ([0, 2], 0.1),
    "tests/old/plants/test_m.py::test_high": ([3], 5.0),
    "tests/a/test_user.py::test_user": ([4], 1.0),
    "tests/gone/test_gone.py::test_low": ([0, 1, 2, 3], 0.1),
}


@pytest.fixture
def tree(tmp_path):
    files = {
        PATH: SOURCE,
        USER: "from runner.plants.m import LIMIT\n\n\ndef ask():\n    return LIMIT\n",
        "runner/plants/constants.py": "WIDE = 2\n",
        "runner/simulation/other.py": "from runner.plants.constants import WIDE\n",
        "tests/a/test_far.py": "",
        "tests/new/plants/test_m.py": "",  # it was moved since
        "tests/a/test_user.py": "",
    }
    for path, text in files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


@pytest.fixture(scope="module")
def coverage():
    ran = np.zeros((len(TESTS), len(BLOCKS)), dtype=bool)
    for row, (blocks, _) in zip(ran, TESTS.values(), strict=True):
        row[blocks] = True
    costs = np.array([cost for _, cost in TESTS.values()])
    return CoverageMap(tuple(BLOCKS), tuple(map(short, TESTS)), costs, ran)


def mutant(line, path=PATH, source=SOURCE):
    """Return the mutant of a module whose line becomes this one."""
    return next(each for each in places(path, source) if each.change(source)[1].strip() == line)


def chosen(coverage, tree, line, limit=60.0, without=()):
    return coverage.choose(mutant(line), tree, limit, without)


def test_those_that_run_the_block_run_cheap_and_narrow_ones_first(coverage, tree):
    assert chosen(coverage, tree, "if a <= LIMIT:").tests == (
        "test_far.py::test_cheap_low",
        "test_far.py::test_low",
        "test_far.py::test_all",
    )
    assert chosen(coverage, tree, "return a - 1").tests == ("test_far.py::test_low", "test_far.py::test_all")
    assert chosen(coverage, tree, "return a + 1").tests == ("test_far.py::test_cheap_low", "test_far.py::test_all")


def test_the_mirrored_file_comes_first_wherever_it_lies_now(coverage, tree):
    choice = chosen(coverage, tree, "return a / 5")
    assert choice.tests == ("test_m.py::test_high", "test_far.py::test_all")
    assert choice.files == ("tests/new/plants/test_m.py", "tests/a/test_far.py")
    assert choice.whole == ("test_m.py",)


@pytest.mark.parametrize(("limit", "count"), [(0.0, 1), (4.9, 1), (5.0, 1), (5.9, 1), (6.0, 2), (60.0, 2)])
def test_they_end_before_the_limit_but_for_the_first(coverage, tree, limit, count):
    choice = chosen(coverage, tree, "return a / 5", limit)
    assert (len(choice.tests), choice.cost) == (count, (5.0, 6.0)[count - 1])


def test_those_that_fail_without_a_mutant_are_left_out(coverage, tree):
    choice = chosen(coverage, tree, "return a / 5", without=["test_m.py::test_high"])
    assert choice.tests == ("test_far.py::test_all",)


def test_what_runs_at_import_is_found_by_the_functions_that_use_it(coverage, tree):
    (limit,) = (each for each in places(PATH, SOURCE) if each.name == "LIMIT")
    assert set(coverage.choose(limit, tree, 60.0).tests) == {
        "test_far.py::test_all", "test_far.py::test_low", "test_far.py::test_cheap_low"
    }  # fmt: skip


def test_where_no_function_uses_it_all_of_the_module_do(coverage, tree):
    (spare,) = (each for each in places(PATH, SOURCE) if each.name == "SPARE")
    assert len(coverage.choose(spare, tree, 60.0).tests) == 4


def test_a_module_without_functions_is_found_by_those_that_import_it(coverage, tree):
    (wide,) = places("runner/plants/constants.py", "WIDE = 2\n")
    assert coverage.choose(wide, tree, 60.0) is None  # only a module that has no function
    (tree / USER).write_text("from runner.plants.constants import WIDE\n")
    choosing.imported.cache_clear()
    assert coverage.choose(wide, tree, 60.0).tests == ("test_user.py::test_user", "test_far.py::test_all")


def test_a_function_that_has_changed_keeps_its_tests(coverage, tree):
    source = SOURCE.replace("    if a < LIMIT:\n", "    a = abs(a)\n    if a < LIMIT and not a:\n")
    (tree / PATH).write_text(source)
    changed = mutant("if a <= LIMIT and not a:", source=source)
    assert len(coverage.choose(changed, tree, 60.0).tests) == 3


def test_a_mutant_that_names_its_test_file_runs_all_of_it(tree):
    named = type(mutant("return a / 5"))(**{**vars(mutant("return a / 5")), "test": "tests/before/test_far.py"})
    choice = CoverageMap().choose(named, tree, 60.0)
    assert (choice.files, choice.tests, choice.whole) == (("tests/a/test_far.py",), (), ("test_far.py",))
