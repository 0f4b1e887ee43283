"""Expressions in double braces: their values, and those that are refused."""

import pytest

from runner.base.errors import RunnerError
from runner.papers.study.grid import alone, fill, names_in


@pytest.mark.parametrize(
    ("expression", "value"),
    [("1 / 250", "0.004"), ("round(0.01 / h) * h", "0.0096"), ("-h + 1", "0.9968"), ("round(1 / 3, 4)", "0.3333"),
     ("round(1234, -2)", "1200"),
     ("round(7, -999999999)", "0"),
     ("(1 + 2) * 3 - 1", "8"), ("1 / 3", "0.333333333"), ("word", "both"), ("word + '!'", "both!"),
     ("2 if h < 1 else 3", "2")],
)  # fmt: skip
def test_arithmetic(expression, value):
    assert fill(f"a={{{{ {expression} }}}}", {"h": 0.0032, "word": "both"}) == f"a={value}"


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        ("mas / 2", r"no name 'mas' \(did you mean mass\?\); names: round, mass, word"),
        ("word * 2", "cannot compute with str and int"),
        ("mass / 0", "has no value: .*division by zero"),
        ("2 ** 63", "has no value"),
        ("__import__('os')", "no name '__import__'"),
        ("word.upper()", "has no 'upper'"),
        ("'a' * 3", "cannot compute with str and int"),
        ("True", "only a finite number or a string"),
        ("[mass]", "only a finite number or a string"),
        ("round(mass, 1, 2)", "TypeError"),
        ("round()", "TypeError"),
        ("1e200 * 1e200", "gives inf"),
        ("1 +", "is not an expression"),
        ("", "is not an expression"),
        ("+".join("1" * 1000), "has 2007 characters; allowed: up to 2000"),
    ],
)
def test_an_expression_that_has_no_value_is_refused(expression, message):
    with pytest.raises(RunnerError, match=message):
        fill(f"a={{{{ {expression} }}}}", {"mass": 1.0, "word": "both"})


def test_braces_that_are_not_closed_are_refused():
    with pytest.raises(RunnerError, match=r"\{\{ is not closed"):
        fill("a={{ mass", {"mass": 1.0})


def test_the_names_of_a_text_and_of_what_stands_alone_are_found():
    assert names_in("a={{ x / 2 }} b={{ controller.period * x }}") == {"x", "controller.period"}
    assert (alone("{{ controller.period }}"), alone("a={{ x }}"), alone("{{ x / 2 }}")) == (
        "controller.period",
        None,
        None,
    )
