"""Audited equations of a report: order, verdicts, folding."""

from runner.base.expressions.parser import parse
from runner.reporting.equation import (
    FOLDED,
    SHOWN,
    Equation,
    EquationForm,
    EquationVerdict,
    Matrix,
    by_finding,
    by_place,
    of_verdict,
)


def equation(number, finding="", notes=(), place="page 1", verdict="wrong as printed"):
    forms = [EquationForm("as printed"), *(EquationForm("repaired", note=note) for note in notes)]
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


def test_equations_are_listed_by_place_and_verdict():
    rows = [equation("1"), equation("2", place="page 2", verdict="correct"), equation("3")]
    assert [(place, [row.number for row in each]) for place, each in by_place(rows)] == [
        ("page 1", ["1", "3"]), ("page 2", ["2"]),
    ]  # fmt: skip
    assert [row.number for row in of_verdict(rows, "correct")] == ["2"]


def test_a_matrix_is_as_wide_as_its_longest_row():
    rows = [[parse(text).root for text in row] for row in (("0", "1"), ("a*b - cos(c)", "d"))]
    assert Matrix(rows).symbols == 5
