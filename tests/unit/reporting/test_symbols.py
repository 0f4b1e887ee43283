"""Letters in texts as symbols with their scripts."""

import pytest

from runner.reporting.equation import Symbol, symbols_in


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("0T_1", [Symbol("T", "0", "1")]),
        ("J_g6,20", [Symbol("J", "", "g6,20")]),
        ("0T6", [Symbol("T", "0", "6")]),
        ("J^+", [Symbol("J", "", "", "+")]),
        ("c(1-2-3)", [Symbol("c", "", "(1−2−3)")]),
        ("A_1^0(q_1)", [Symbol("A", "", "1", "0"), Symbol("("), Symbol("q", "", "1"), Symbol(")")]),
        ("text: P_ij", [Symbol("text: "), Symbol("P", "", "ij")]),
        ("J_ω5 I J_ω5", [Symbol("J", "", "ω5"), Symbol(" I "), Symbol("J", "", "ω5")]),
    ],
)
def test_letters_have_their_scripts(name, expected):
    assert symbols_in(name) == expected


@pytest.mark.parametrize("name", ["(3.25) of the Mini", "Table 1, row 2", "theta (acos)", "M(q)", "text: z, x, x", ""])
def test_words_and_numbers_stay_as_they_are(name):
    assert all(each.plain for each in symbols_in(name))
    assert "".join(each.text for each in symbols_in(name)) == name
