"""Marks on parts of a string that the other text lacks."""

from runner.papers.reporting.audit_forms import LONG, cut, pieces


def test_what_the_other_text_lacks_is_marked():
    assert pieces("a = b", "a = c") == [(False, "a = "), (True, "b")]
    assert pieces("a b", "a c b") == [(False, "a "), (True, "\u200a"), (False, "b")]


def test_long_stretches_in_common_are_cut():
    found = pieces("x" * LONG + "b", "x" * LONG + "c")
    assert found[-1] == (True, "b")
    assert len(found[0][1]) < LONG / 2
    assert cut("x" * (LONG + 1)) == [(False, "x" * LONG + " …")]
