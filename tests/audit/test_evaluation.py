"""Values of printed expressions against Python's arithmetic."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.audit.evaluation import evaluate
from runner.expressions.parser import ExpressionError, parse

X = np.array([0.3, -1.2, 2.0])
Y = np.array([1.5, 0.4, -0.7])


def value(text, **symbols):
    return evaluate(parse(text), {"x": X, "y": Y} | symbols)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 - 2 - 3", -4 + 0 * X),
        ("2/3/4", 2 / 3 / 4 + 0 * X),
        ("x/y*x", X / Y * X),
        ("-x^2", -(X**2)),
        ("(-x)**2", X**2),
        ("2^3^2", 512 + 0 * X),
        ("2^-1", 0.5 + 0 * X),
        ("x - -y", X + Y),
        ("-x*y + x", -X * Y + X),
        ("+x", X),
        ("-(x + y)*2", -2 * (X + Y)),
        ("1.5e-3*x + .5", 1.5e-3 * X + 0.5),
        ("sin(x)^2 + cos(x)^2", 1 + 0 * X),
        ("atan2(sin(x), cos(x))", X),
        ("tan(arctan(y))", Y),
        ("asin(sin(0.3)) + arccos(cos(0.4))", 0.7 + 0 * X),
        ("sqrt(x^2)", np.abs(X)),
        ("abs(x)", np.abs(X)),
    ],
)
def test_values_follow_the_rules_of_arithmetic(text, expected):
    np.testing.assert_allclose(value(text), expected, rtol=1e-14, atol=1e-14)


LEAVES = st.sampled_from(["x", "y", "2", "0.5", "7"])
TREES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*"), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
        inner.map(lambda t: f"-{t}"),
        inner.map(lambda t: f"sin({t})"),
    ),
    max_leaves=12,
)


@given(TREES)
def test_any_expression_has_the_value_that_python_gives_it(text):
    expected = eval(text, {"__builtins__": {}}, {"x": X, "y": Y, "sin": np.sin})
    np.testing.assert_allclose(value(text), expected + 0 * X, rtol=1e-12, atol=1e-12)


def test_an_unknown_name_is_told_with_the_nearest():
    with pytest.raises(
        ExpressionError, match=r"position 5: unknown name 'thet1' \(did you mean theta1\?\); names: x, y"
    ):
        value("x + thet1", theta1=X)


@pytest.mark.parametrize(
    ("text", "position", "reason"),
    [
        ("1/(x - 2)", 4, "division by zero at sample 3 (x = 2)"),
        ("y/0", 3, "division by zero at sample 1"),
        ("(x - 2)^-1", 8, "division by zero (a negative power of 0) at sample 3"),
        ("sqrt(y)", 1, "sqrt of a number outside its domain at sample 3 (y = -0.7)"),
        ("asin(x)", 1, "asin of a number outside its domain at sample 2"),
        ("x^0.5", 2, "no finite real number at sample 2"),
        ("9^9^9", 2, "no finite real number at sample 1"),
        ("10^300*10^300", 1, "a product that is not finite at sample 1"),
    ],
)
def test_a_sample_without_value_is_told_with_its_position(text, position, reason):
    with pytest.raises(ExpressionError) as error:
        value(text)
    assert reason in str(error.value)
    assert error.value.position == position
