"""Strings of equations compared piece by piece, and cut to what differs."""

from runner.papers.expressions.tree import ELLIPSIS
from runner.papers.reporting.audit_forms import LONG, cut, pieces


def test_a_lost_bracket_leaves_a_mark_where_it_was():
    assert [piece for marked, piece in pieces("J = -(a + b", "J = -(a + b)") if marked] == ["\u200a"]
    assert pieces("J = -(a + b)", "J = -(a + b") == [(False, "J = -(a + b"), (True, ")")]


def test_a_long_text_is_cut_to_what_differs_and_what_stands_around_it():
    text = "a" * LONG + "x" + "b" * LONG
    found = pieces(text, text.replace("x", "y"))
    assert [piece for marked, piece in found if marked] == ["x"]
    assert found[0][1].startswith(f" {ELLIPSIS} ")
    assert found[-1][1].endswith(f" {ELLIPSIS} ")
    assert sum(len(piece) for _, piece in found) < LONG


def test_the_beginning_of_a_text_that_has_none_beside_it():
    assert cut("a" * LONG) == [(False, "a" * LONG)]
    ((_, shown),) = cut("a" * LONG + "b")
    assert shown == "a" * LONG + f" {ELLIPSIS}"
