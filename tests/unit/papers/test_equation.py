"""Audited equations of a report: order, verdicts, folding, names."""

import pytest

from runner.papers.reporting.equation import (
    FOLDED,
    SHOWN,
    Equation,
    EquationForm,
    EquationVerdict,
    by_finding,
    by_place,
    name_text,
)


def equation(number, finding="", notes=(), place="page 1", verdict="wrong as printed"):
    forms = [EquationForm("as printed"), *(EquationForm("emended", note=note) for note in notes)]
    return Equation(number, "", place, verdict, "", forms, finding)


def test_every_verdict_is_shown_or_folded():
    assert sorted((*SHOWN, *FOLDED)) == sorted(EquationVerdict.__args__)


def test_equations_of_which_the_same_is_told_stand_together_and_lose_it():
    rows = [equation("1", "Lost."), equation("2"), equation("3", "Lost."), equation("4", notes=["Torn."])]
    rows += [equation("5", notes=["Torn."]), equation("6")]
    found = by_finding(rows)
    assert [(words, [row.number for row in each]) for words, each in found] == [
        ("Lost.", ["1", "3"]), ("", ["2"]), ("Torn.", ["4", "5"]), ("", ["6"]),
    ]  # fmt: skip
    assert not any(row.finding or form.note for _, each in found for row in each for form in row.forms)


def test_a_note_beside_a_finding_stays():
    ((words, (row,)),) = by_finding([equation("1", "Wrong.", ["Mended."])])
    assert (words, row.forms[1].note) == ("Wrong.", "Mended.")


def test_equations_are_listed_by_place():
    rows = [equation("1"), equation("2", place="page 2", verdict="correct"), equation("3")]
    assert [(place, [row.number for row in each]) for place, each in by_place(rows)] == [
        ("page 1", ["1", "3"]), ("page 2", ["2"]),
    ]  # fmt: skip


def letter(letter, **scripts):
    return f'$attach(italic("{letter}")' + "".join(f', {place}: "{text}"' for place, text in scripts.items()) + ")$"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("0T_1", letter("T", tl="0", br="1")),
        ("J_g6,20", letter("J", br="g6,20")),
        ("0T6", letter("T", tl="0", br="6")),
        ("J^+", letter("J", tr="+")),
        ("c(1-2-3)", letter("c", br="(1−2−3)")),
        ("A_1^0(q_1)", f"{letter('A', br='1', tr='0')}({letter('q', br='1')})"),
        ("text: P_ij", f"text: {letter('P', br='ij')}"),
        ("J_ω5 I J_ω5", f"{letter('J', br='ω5')} I {letter('J', br='ω5')}"),
        ("(a$)", "(a$$)"),
    ],
)
def test_letters_of_a_name_have_their_scripts(name, expected):
    assert name_text(name) == expected


@pytest.mark.parametrize("name", ["(3.25) of the Mini", "Table 1, row 2", "theta (acos)", "M(q)", "text: z, x, x", ""])
def test_words_and_numbers_of_a_name_stay_as_they_are(name):
    assert name_text(name) == name
