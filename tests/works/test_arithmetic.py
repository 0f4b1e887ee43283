"""Expressions in double braces: what they are worth, and which are refused."""

import pytest

from runner.errors import RunnerError
from runner.works.arithmetic import alone, fill, names_in


@pytest.mark.parametrize(
    ("expression", "value"),
    [("1 / 250", "0.004"), ("round(0.01 / h) * h", "0.0096"), ("-h + 1", "0.9968"), ("round(1 / 3, 4)", "0.3333"),
     ("(1 + 2) * 3 - 1", "8"), ("1 / 3", "0.333333333"), ("word", "both")],
)  # fmt: skip
def test_arithmetic(expression, value):
    assert fill(f"a={{{{ {expression} }}}}", {"h": 0.0032, "word": "both"}) == f"a={value}"


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        ("mas / 2", r"'mas' is neither an axis nor a value \(did you mean mass\?\); known: mass, word"),
        ("word * 2", "'word' is the text 'both', which no arithmetic takes"),
        ("mass / 0", "has no value"),
        ("2 ** 9", "only numbers, names"),
        ("__import__('os')", "only numbers, names"),
        ("mass if mass else 1", "only numbers, names"),
        ("'a' * 3", "only numbers, names"),
        ("True", "only numbers, names"),
        ("round(mass, 1, 2)", "only numbers, names"),
        ("round()", "only numbers, names"),
        ("1e200 * 1e200", "it is not finite"),
        ("1 +", "is no expression"),
        ("", "is no expression"),
        ("+".join("1" * 200), "is no expression of at most 200"),
    ],
)
def test_an_expression_that_has_no_value_is_refused(expression, message):
    with pytest.raises(RunnerError, match=message):
        fill(f"a={{{{ {expression} }}}}", {"mass": 1.0, "word": "both"})


def test_braces_that_are_not_closed_are_refused():
    with pytest.raises(RunnerError, match="has double braces that are not closed"):
        fill("a={{ mass", {"mass": 1.0})


def test_the_names_of_a_text_and_of_what_stands_alone_are_found():
    assert names_in("a={{ x / 2 }} b={{ controller.period * x }}") == {"x", "controller.period"}
    assert (alone("{{ controller.period }}"), alone("a={{ x }}"), alone("{{ x / 2 }}")) == (
        "controller.period",
        None,
        None,
    )
