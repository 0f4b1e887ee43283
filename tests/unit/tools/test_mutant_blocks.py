"""Blocks of statements and their probes: a module with probes gives the same results and reports what ran."""

import ast
import sys
from textwrap import dedent
from types import SimpleNamespace

import pytest

from tools.mutants.inside.blocks import instrument, mark

SOURCE = dedent('''\
    """A module."""

    from __future__ import annotations

    LIMIT = 3
    twice = lambda a: 2 * a


    def f(a):
        """Say what f does."""
        if a > LIMIT:
            for k in range(a):
                a += k
        else:
            a = twice(a)
        try:
            return 1 / a
        except ZeroDivisionError:
            return None


    class A:
        """A class."""

        most = 4

        def g(self, values):
            def inner(value):
                return value + self.most

            with open("/dev/null"):
                pass
            return [inner(value) for value in values]

        def empty(self):
            """Do nothing."""
''')


def owners():
    return [(block.owner, block.ordinal) for block in mark(ast.parse(SOURCE))]


def run(monkeypatch):
    """Return the module with probes, and the bytes that they set."""
    tree, hits = ast.parse(SOURCE), bytearray(len(owners()) + 5)
    instrument(tree, 5)

    def hit(index):
        hits[index] = 1

    monkeypatch.setitem(sys.modules, "block_probes", SimpleNamespace(hits=hits, hit=hit))
    module = {"__name__": "m"}
    exec(compile(tree, "m.py", "exec"), module)
    return module, hits


def test_a_block_begins_in_each_body_and_behind_each_statement_with_bodies():
    assert owners() == [
        ("<lambda>", 0),
        *(("f", ordinal) for ordinal in range(7)),
        ("A.g", 0),
        ("A.g.inner", 0),
        ("A.g", 1),
        ("A.g", 2),
        ("A.empty", 0),
    ]


@pytest.mark.parametrize(
    ("call", "value", "ran"),
    [
        (lambda m: m["f"](4), 0.1, {("f", 0), ("f", 1), ("f", 2), ("f", 4), ("f", 5)}),
        (lambda m: m["f"](1), 0.5, {("f", 0), ("f", 3), ("<lambda>", 0), ("f", 4), ("f", 5)}),
        (lambda m: m["f"](0), None, {("f", 0), ("f", 3), ("<lambda>", 0), ("f", 4), ("f", 5), ("f", 6)}),
        (lambda m: m["A"]().g([1, 2]), [5, 6], {("A.g", 0), ("A.g", 1), ("A.g", 2), ("A.g.inner", 0)}),
        (lambda m: m["A"]().empty(), None, {("A.empty", 0)}),
    ],
    ids=["a loop", "a lambda", "an exception", "a function within one", "only a docstring"],
)
def test_what_runs_sets_its_byte_and_the_value_is_that_without_probes(monkeypatch, call, value, ran):
    module, hits = run(monkeypatch)
    assert not any(hits)  # at import no function has run
    assert call(module) == value
    assert {owner for owner, byte in zip(owners(), hits[5:], strict=True) if byte} == ran
    assert not any(hits[:5])


def test_docstrings_stay_where_they_are(monkeypatch):
    module, _ = run(monkeypatch)
    assert (module["__doc__"], module["f"].__doc__, module["A"].empty.__doc__) == (
        "A module.", "Say what f does.", "Do nothing."
    )  # fmt: skip
