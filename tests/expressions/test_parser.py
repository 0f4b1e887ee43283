"""Parser of expressions: positions in messages, limits of length, order of names."""

import pytest

from runner.expressions.parser import ExpressionError, parse
from runner.expressions.tree import names


@pytest.mark.parametrize(
    ("text", "position", "reason"),
    [
        ("", 1, "is empty"),
        ("   ", 4, "is empty"),
        ("sin(q1", 4, "this '(' is never closed"),
        ("(q1*(q2 + 1)", 1, "this '(' is never closed"),
        ("q1)", 3, "this ')' has no '(' before it"),
        ("()", 2, "should stand before this ')'"),
        ("q1 +", 5, "the expression ends where"),
        ("q1 * / q2", 6, "'/' cannot stand here"),
        ("2 q1", 3, "a product needs its '*'"),
        ("c1(q2)", 1, "'c1' is no function"),
        ("sine(q1)", 1, "did you mean sin?"),
        ("exec(q1)", 1, "is no function that can be called"),
        ("q1.real", 3, "attribute access is no arithmetic"),
        ("__import__('os').system('ls')", 1, "'__import__' is no function"),
        ("(lambda: 1)()", 8, "':' is no sign of arithmetic"),
        ("q1[0]", 3, "'[' is no sign of arithmetic"),
        ("'a'*9", 1, "no sign of arithmetic"),
        ("q1, q2", 3, "',' cannot stand here"),
        ("sin(q1, q2)", 1, "sin takes 1 argument(s), not 2"),
        ("atan2(q1)", 1, "atan2 takes 2 argument(s), not 1"),
        ("1e999", 1, "is too large"),
        ("1.2.3", 4, "follows without a sign"),
        ("a + … b", 5, "the text is lost here"),
        ("(" * 70 + "1" + ")" * 70, 62, "nested more than 60 deep"),
        ("-" * 5000 + "1", 63, "nested more than 60 deep"),
    ],
    ids=lambda part: part[:40] if isinstance(part, str) else None,
)
def test_what_cannot_be_read_is_told_with_its_position(text, position, reason):
    with pytest.raises(ExpressionError) as error:
        parse(text)
    assert reason in str(error.value)
    assert error.value.position == position


def test_the_message_points_into_the_text():
    with pytest.raises(ExpressionError) as error:
        parse("sin(q1)*cos(q2) + 3 $ q3")
    first, excerpt, mark = str(error.value).splitlines()
    assert first.startswith("position 21: '$' is no sign of arithmetic")
    assert excerpt[mark.index("^")] == "$"


def test_in_a_long_text_the_message_shows_the_neighbourhood():
    with pytest.raises(ExpressionError) as error:
        parse("q1 + " * 200 + "?" + " + q1" * 200)
    _, excerpt, mark = str(error.value).splitlines()
    assert excerpt[mark.index("^")] == "?"
    assert len(excerpt) < 80


def test_an_expression_that_is_too_long_is_refused():
    with pytest.raises(ExpressionError, match="at most 100000"):
        parse("1" * 100_001)


def test_thousands_of_terms_are_read():
    assert len(names(parse(" + ".join(["q1*q2"] * 5000)).root)) == 10_000


def test_names_stand_in_order_with_their_place():
    found = names(parse("s2'*l_4 + sin(theta1)^k").root)
    assert [(name.name, name.index) for name in found] == [("s2'", 0), ("l_4", 4), ("theta1", 14), ("k", 22)]
