"""Forms of an audited equation: printed, corrected, and where they differ."""

import pytest

from runner.papers.audit.entry import Emendation, Entry, Form, Printed
from runner.papers.audit.verdict import CheckedEquation
from runner.papers.reporting.audit_forms import RightElements, forms_of

LONG = " + ".join(f"x{i}*y{i}*z{i}" for i in range(20))


def entry(printed, corrected=None, emendation=None, name="J_11"):
    return Entry(
        id=name, number=name, place="page 1", title="", printed=Printed(elements={name: printed}),
        emendation=emendation and Emendation(why="Torn.", elements={name: emendation}),
        corrected=corrected and Form(elements={name: corrected}),
    )  # fmt: skip


def forms(given, *others):
    checked = [CheckedEquation("paper", each, "wrong as printed", None, None, ("", "")) for each in (given, *others)]
    return forms_of(given, RightElements(checked))


def formula(form):
    ((only,),) = form.lines
    return only


def test_printed_and_corrected_have_what_differs_marked():
    printed, corrected = forms(entry("a*cos(q1) + b", "a*cos(theta1) + b"))
    assert (printed.label, corrected.label) == ("as printed", "corrected")
    assert formula(printed).count("differs(") == formula(corrected).count("differs(") == 1
    assert 'differs(italic("q")_"1")' in formula(printed)
    assert 'differs(italic("θ")_"1")' in formula(corrected)
    assert printed.whole == corrected.whole == ""


def test_a_long_form_is_cut_to_what_differs_and_stands_whole_as_well():
    printed, corrected = forms(entry(f"{LONG} + p*q*r", f"{LONG} + p*q*s"))
    assert [letters for letters in "…pqrs" if f'"{letters}"' in formula(printed)] == ["…", "p", "q", "r"]
    assert "x₁₉ y₁₉ z₁₉ + p q r" in printed.whole
    assert "p q s" in corrected.whole


def test_a_form_that_stands_in_anothers_place_is_told_by_its_name():
    shifted, other = entry(LONG.replace("x3", "q3"), "0"), entry(LONG, LONG, name="J_12")
    printed, _ = forms(shifted, other)
    assert 'It is the right $italic("J")_"12"$, with $italic("q")_"3"$ for $italic("x")_"3"$.' in printed.note
    assert not printed.lines
    assert printed.whole


@pytest.mark.parametrize("printed", ["2*(a + b", "2 a"])
def test_what_cannot_be_read_is_shown_as_text(printed):
    first, second = forms(entry(printed, emendation="2*(a + b)"))
    assert "".join(piece for _, piece in first.raw).replace("\u200a", "") == f"J_11 = {printed}"
    assert (second.label, second.note) == ("emended", "Torn.")
    assert any(marked for marked, _ in (*first.raw, *second.raw))


def test_a_right_form_is_shown_whole():
    (only,) = forms(entry(LONG))
    assert formula(only).count("italic(") == 61
    assert "differs" not in formula(only)
