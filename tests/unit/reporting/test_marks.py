"""Marks on parts of a formula that the other form lacks."""

import pytest

from runner.reporting import formulas
from runner.reporting.audit.marks import marked_formulas


@pytest.mark.parametrize(
    ("first", "second", "left", "right"),
    [
        ("i, d_i = 2, theta_2, 0", "i, d_i = 2, theta_2 - 90 degree, 0", 0, ["differs(- 90 degree)"]),
        ("M_p = r F", "M_q = r times F", ["differs(M_p)"], ["differs(M_q)", "differs(times)"]),
        ("J = mat(a, b; Z_1, Z_2)", "J = mat(a, b; Z_0, Z_2)", ["differs(Z_1)"], ["differs(Z_0)"]),
        ("x = a b", "x = a b", 0, 0),
        ('p = "with (a b" c', 'p = "with (a b" d', ["differs(c)"], ["differs(d)"]),
    ],
)
def test_what_the_other_formula_lacks_is_marked(first, second, left, right):
    for found, expected in zip(marked_formulas(first, second), (left, right), strict=True):
        assert found.count("differs(") == len(expected or ())
        assert all(each in found for each in expected or ())
        assert formulas.mathml([found], displayed=False)[found] is not None


def test_formulas_that_share_nothing_have_no_mark():
    assert marked_formulas("a = b c", "p q r") == ("a = b c", "p q r")
