"""Formulas in words."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.reporting.spoken import spoken


@pytest.mark.parametrize(
    ("typst", "words"),
    [
        ("t_f = 3", "t f equals 3"),
        ("omega_n^2 = k_p", "omega n squared equals k p"),
        ("J M^(-1) G slash omega_n^2", "J M inverse G over omega n squared"),
        ("(J^T J)^(-1) J^T", "J transposed J inverse J transposed"),
        ("|dot(x)_d - dot(x)_E|", "the size of x dot d minus x dot E"),
        ("s_23 = sin(q_2 + q_3)", "s 23 equals sin q 2 plus q 3"),
        ("w = sqrt(det J J^T)", "w equals the root of det J J transposed"),
        ("hat(p)(x)", "p hat x"),
        ("n -> infinity", "n goes to infinity"),
        ("P_(e x), P_(e y)", "P e x, P e y"),
        ("frac(a, b) >= 1", "a over b is at least 1"),
        ('x "in the end"', "x in the end"),
        ("dot.double(q)", "q double dot"),
        ("", ""),
    ],
)
def test_formulas_in_words(typst, words):
    assert spoken(typst) == words


@given(st.text(max_size=60))
def test_any_text_ends(text):
    assert isinstance(spoken(text), str)
