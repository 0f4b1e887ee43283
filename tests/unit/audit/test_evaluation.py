"""Values of printed expressions against Python's arithmetic."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.base.errors import RunnerError
from runner.papers.audit.evaluation import Numbered, SampleValues, evaluate, evaluate_sides
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.parser import parse

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


def test_values_have_the_bits_of_numpy():
    expected = -(X ** np.array([2.0])) * Y + np.array([0.1]) / X - np.array([7.0]) ** np.array([0.5]) * np.sin(Y)
    np.testing.assert_array_equal(value("-x^2*y + .1/x - 7^0.5*sin(y)"), expected)


@pytest.mark.parametrize("name", ["s2'", "x''", "µ_1", "Größe", "theta1"])
def test_names_are_found_as_they_are_written(name):
    np.testing.assert_array_equal(value(f"2*{name} - x^2", **{name: Y}), 2 * Y - X**2)


def test_a_number_alone_stands_at_every_sample():
    np.testing.assert_array_equal(value("2"), [2.0, 2.0, 2.0])
    np.testing.assert_array_equal(evaluate(parse("9007199254740993*1"), {}), [9007199254740992.0])


RNG = np.random.default_rng(0)
J, M, V, K = (RNG.normal(size=(4, *shape)) for shape in ((3, 3), (3, 3), (3,), ()))
SHAPED = {"J": J, "M": M, "v": V, "k": K}


def test_matrices_and_vectors_have_the_bits_of_numpy():
    inverse = np.linalg.inv(J)
    moved = evaluate(parse("transpose(inverse(J)) @ M @ inverse(J)"), SHAPED)
    np.testing.assert_array_equal(moved, inverse.transpose(0, 2, 1) @ M @ inverse)
    scaled = evaluate(parse("-k*v + J @ v"), SHAPED)
    np.testing.assert_array_equal(scaled, -K[:, None] * V + np.einsum("tij,tj->ti", J, V))
    np.testing.assert_array_equal(evaluate(parse("cross(v, 2*v) + v"), SHAPED), V)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("v @ J", "a vector of 3 @ a 3 by 3 matrix do not fit"),
        ("J + v", "a 3 by 3 matrix and a vector of 3 do not fit"),
        ("v*v", "a vector of 3 @ a vector of 3 do not fit"),
        ("k/J", "a number / a 3 by 3 matrix do not fit"),
        ("[[J, k], [0, 1]]", "blocks of 1 and 3 rows or columns do not fit"),
        ("[[J, v], [0]]", "the rows of the matrix have different lengths"),
        ("skew(k)", "skew takes a vector of 3, not a number"),
        ("log(v)", "log takes a rotation, not a vector of 3"),
        ("inverse(v)", "inverse takes a square matrix, not a vector of 3"),
        ("transpose(k)", "transpose takes a matrix, not a number"),
        ("cross(v, k)", "cross takes two vectors of 3, not a number"),
        ("inverse(J - J)", "the matrix is singular at every sample"),
    ],
)
def test_shapes_that_do_not_fit_are_told(text, told):
    with pytest.raises(ExpressionError, match=f"has no value: {told}"):
        evaluate(parse(text), SHAPED)


def test_matrices_of_blocks_have_zeros_that_fill_and_ones_that_do_not():
    zero, corner = np.zeros((4, 1, 3)), np.ones((4, 1, 1))
    expected = np.concatenate([np.concatenate([J, V[:, :, None]], 2), np.concatenate([zero, corner], 2)], 1)
    np.testing.assert_array_equal(evaluate(parse("[[J, v], [0, 1]]"), SHAPED), expected)
    np.testing.assert_array_equal(evaluate(parse("[k, 2, v]"), SHAPED), np.column_stack([K, 2 + 0 * K, V]))
    np.testing.assert_array_equal(evaluate(parse("[[v, 0, 2*v]]"), SHAPED), np.stack([V, 0 * V, 2 * V], axis=2))
    assert evaluate(parse("[0, 0, 0]"), SHAPED).shape == (4, 3)


def test_a_row_times_a_column_is_a_number():
    np.testing.assert_allclose(
        evaluate(parse("transpose(v) @ M @ v/2"), SHAPED), np.einsum("ti,tij,tj->t", V, M, V) / 2
    )


def test_turns_and_vectors_agree():
    np.testing.assert_array_equal(evaluate(parse("skew(v) @ J @ v - cross(v, J @ v)"), SHAPED).round(14), 0 * V)
    back = evaluate(parse("log(R_x(0.3)) - [0.3, 0, 0] + log(R_y(k/9) @ R_y(-k/9))"), SHAPED)
    np.testing.assert_allclose(back, 0 * V, atol=1e-15)
    moved = evaluate(parse("Rot_z(k) @ Tra_x(2) @ [0, 0, 0, 1]"), SHAPED)
    np.testing.assert_allclose(moved, np.column_stack([2 * np.cos(K), 2 * np.sin(K), 0 * K, 1 + 0 * K]), atol=1e-15)


def test_letters_in_square_brackets_stand_for_numbers():
    several = {f"x_{i}": i * X for i in range(4)} | {"x_2n": Y, "n": X}
    text = "sum(i, 1, 3, x[i] - x[i-1]) + x[2, n] - x[k+1]"
    np.testing.assert_allclose(evaluate(parse(text), several, {"k": 1}), 3 * X + Y - 2 * X)
    with pytest.raises(ExpressionError, match=r"position 1: no name 'x_5'"):
        evaluate(parse("x[k]"), several, {"k": 5})
    with pytest.raises(ExpressionError, match="take more than 10000 operations"):
        evaluate(parse("sum(i, 1, 999, sum(j, 1, 999, i))"), {"i": X})


def test_an_equation_has_a_value_on_each_side():
    first, second = evaluate_sides(parse("J @ v = 2*v"), SHAPED)
    np.testing.assert_array_equal(first, evaluate(parse("J @ v"), SHAPED))
    np.testing.assert_array_equal(second, 2 * V)


def test_an_inverse_that_exists_at_some_samples_has_no_number_at_the_others():
    matrices = J.copy()
    matrices[1] = 0.0
    found = evaluate(parse("2*inverse(J) @ v"), SHAPED | {"J": matrices})
    assert np.isnan(found[1]).all()
    assert np.isfinite(found[[0, 2, 3]]).all()


def test_an_expression_uses_others_and_never_itself():
    texts = {"Lambda": "transpose(J) @ J", "mu": "Lambda @ v", "F": "mu - v", "a": "b + k", "b": "a"}
    values = SampleValues(SHAPED, {name: Numbered(text) for name, text in texts.items()})
    np.testing.assert_array_equal(values["F"], evaluate(parse("transpose(J) @ J @ v - v"), SHAPED))
    assert values.used == {"Lambda", "mu", "F"}
    with pytest.raises(RunnerError, match="a uses b uses a: an element cannot use itself"):
        values["a"]


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
        ExpressionError, match=r"position 5: no name 'thet1' \(did you mean theta1\?\); names: .*, x, y, theta1"
    ):
        value("x + thet1", theta1=X)


@pytest.mark.parametrize(
    ("text", "position", "reason"),
    [
        ("1/(x - 2)", 4, "division by zero at sample 3 (x = 2)"),
        ("y/0", 3, "division by zero at sample 1"),
        ("(x - 2)^-1", 9, "power gives no finite real number at sample 3 (x = 2)"),
        ("sqrt(y)", 1, "sqrt gives no finite real number at sample 3 (y = -0.7)"),
        ("y + asin(x)", 5, "arcsin gives no finite real number at sample 2 (y = 0.4, x = -1.2)"),
        ("x^0.5", 3, "power gives no finite real number at sample 2"),
        ("9^9^9", 3, "power gives no finite real number at sample 1"),
        ("x^2 + 10^300*10^300", 14, "multiply gives no finite real number at sample 1"),
        ("10^300/10^-300", 8, "divide gives no finite real number at sample 1"),
        ("10^308 + 10^308", 10, "add gives no finite real number at sample 1"),
        ("-10^308 - 10^308", 11, "subtract gives no finite real number at sample 1"),
    ],
)
def test_a_sample_without_value_is_told_with_its_position(text, position, reason):
    with pytest.raises(ExpressionError) as error:
        value(text)
    assert reason in str(error.value)
    assert error.value.position == position
