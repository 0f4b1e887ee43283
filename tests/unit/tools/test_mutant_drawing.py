"""Samples of mutants: the same seed draws the same ones where the code around them changes."""

import json

from tools.mutants.drawing import draw
from tools.mutants.places import places
from tools.mutants.results import again, table

FUNCTIONS = [f"def f{k}(a, b):\n    return a < {k} and b + a\n\n" for k in range(10)]


def drawn(source, sample=8, seed=3, path="runner/m.py"):
    return draw(places(path, source), {path: source}, sample, seed)


def names(mutants):
    return [mutant.identity for mutant in mutants]


def test_the_same_seed_draws_the_same_and_another_one_others():
    source = "".join(FUNCTIONS)
    assert names(drawn(source)) == names(drawn(source))
    assert names(drawn(source, seed=4)) != names(drawn(source))
    assert len(set(names(drawn(source)))) == 8


def test_a_larger_sample_begins_with_the_smaller():
    source = "".join(FUNCTIONS)
    assert names(drawn(source, 16))[:8] == names(drawn(source, 8))
    assert len(drawn(source, 10_000)) == sum(mutant.changes(source) for mutant in places("runner/m.py", source))


def test_functions_that_move_or_come_change_only_their_own_draws():
    before, moved = "".join(FUNCTIONS), "import numpy\n\n" + "".join(reversed(FUNCTIONS))
    assert names(drawn(before)) == names(drawn(moved))
    more = before + "def g(a):\n    return a * 2\n"
    new = [name for name in names(drawn(more)) if name not in names(drawn(before))]
    assert set(names(drawn(more))) - set(new) <= set(names(drawn(before)))
    assert len(new) <= len(places("runner/m.py", "def g(a):\n    return a * 2\n"))


def test_two_equal_functions_have_mutants_of_their_own():
    source = (
        "class A:\n    def f(self, a):\n        return a < 1\n\nclass B:\n    def f(self, a):\n        return a < 1\n"
    )
    found = places("runner/m.py", source)
    assert len(set(names(found))) == len(found) == 4


def result(mutant, source, status):
    was, now = mutant.change(source)
    return {
        "mutant": mutant.identity, "path": mutant.path, "line": mutant.line(source), "owner": mutant.owner,
        "was": was, "now": now, "status": status, "by": "",
    }  # fmt: skip


def test_mutants_of_a_file_are_found_again_by_function_then_by_line(tmp_path, capsys):
    source = "".join(FUNCTIONS[:3])
    mutants = places("runner/m.py", source)
    file = tmp_path / "results.jsonl"
    file.write_text("".join(json.dumps(result(mutant, source, "killed")) + "\n" for mutant in mutants))
    assert again(file, mutants, {"runner/m.py": source}) == mutants
    other = "# more\n" + source.replace("(a, b):", "(a, b, c=None):").replace("a < 2", "a <= 2 * b")
    found = again(file, places("runner/m.py", other), {"runner/m.py": other})
    same = [mutant for mutant in mutants if mutant.owner != "f2"]
    assert [mutant.change(other) for mutant in found] == [mutant.change(source) for mutant in same]
    assert [(mutant.owner, mutant.block) for mutant in found] == [(mutant.owner, mutant.block) for mutant in same]
    gone = capsys.readouterr().out.splitlines()
    assert len(gone) == len(mutants) - len(same) > 0
    assert all("gone" in line and "return a < 2 and b + a" in line for line in gone)


def test_the_table_counts_by_package_and_shows_what_was_not_found():
    results = [
        {"path": path, "line": 7, "owner": "f", "was": "  a < b", "now": "  a <= b", "status": status}
        for path, status in [
            ("runner/plants/rk4.py", "killed"),
            ("runner/plants/rk4.py", "timeout"),
            ("runner/papers/studies/thesis/a.py", "survived"),
            ("runner/cli/main.py", "not covered"),
        ]
    ]
    lines = list(table(results))
    counts = {line.split()[0]: line.split()[1:] for line in lines[1:5]}
    assert counts == {
        "runner/cli": ["0", "0", "0", "1"],
        "runner/plants": ["1", "1", "0", "0"],
        "runner/papers": ["0", "0", "1", "0"],
        "all": ["1", "1", "1", "1"],
    }
    assert lines[5:] == [
        "survived: runner/papers/studies/thesis/a.py:7 f", "  - a < b", "  + a <= b",
        "not covered: runner/cli/main.py:7 f", "  - a < b", "  + a <= b",
    ]  # fmt: skip
