"""Typeset expressions: valid mathematics with subscripts, brackets and signs."""

import pytest

from runner.papers.expressions.parser import parse
from runner.papers.expressions.typesetting import linear, symbol, typeset
from runner.reporting import mathml


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("s12", ("s", "12")),
        ("theta1", ("θ", "1")),
        ("J_11", ("J", "11")),
        ("S_beta", ("S", "β")),
        ("P_ex", ("P", "ex")),
        ("s2'", ("s′", "2")),
        ("Gcos", ("Gcos", "")),
        ("J_g0_32", ("J", "g0,32")),
        ("c1_2_3", ("c", "(1−2−3)")),
        ("T_1_2", ("T", "1,2")),
    ],
)
def test_digits_and_what_follows_an_underscore_are_subscripts(name, expected):
    assert symbol(name) == expected


def test_products_lose_their_sign_but_not_between_numbers():
    assert typeset(parse("2*l4*cos(q1)").root) == '2 italic("l")_"4" cos \\(italic("q")_"1"\\)'
    assert " dot " in typeset(parse("2*3").root)


@pytest.mark.parametrize(
    ("one", "other"),
    [("(a + b)*c", "a + b*c"), ("a - (b - c)", "a - b - c"), ("(a*b)^2", "a*b^2"), ("a/(b*c)", "a/b*c"),
     ("-(a + b)", "-a + b"), ("(a^b)^c", "a^b^c"), ("sin(x)^2", "sin(x^2)")],
)  # fmt: skip
def test_brackets_that_matter_are_seen(one, other):
    assert typeset(parse(one).root) != typeset(parse(other).root)


def test_matrices_are_set_as_a_source_prints_them():
    letters = {"J": "J(q)", "dq": "dot(q)"}
    for text, expected in (
        ("transpose(inverse(J)) @ M", 'J(q)^(-T) italic("M")'),
        ("transpose(J)", "J(q)^(T)"),
        ("inverse(J @ M) @ dq", '(J(q) italic("M"))^(-1) dot(q)'),
        ("J @ cross(a, b + c)", 'J(q) \\(italic("a") times \\(italic("b") + italic("c")\\)\\)'),
        ("[dq, 0]", 'mat(delim: "[", display(dot(q)); display(0))'),
        ("J_v[i] - Z[i-1, n]", 'italic("J")_("v" i) - italic("Z")_(i-1 \\, n)'),
        ("sum(i, 1, 3, k + J[i]) @ dq", '\\(sum_(italic("i") = 1)^(3) \\(italic("k") + J(q)_(i)\\)\\) dot(q)'),
        ("Rot_x(a) @ R_z(b)", '"Rot" \\(x\\, italic("a")\\) R_z \\(italic("b")\\)'),
        ("skew(dq) @ log(J)", "[dot(q)]_times log \\(J(q)\\)^or"),
        ("J @ dq = 0", "J(q) dot(q) = 0"),
    ):
        assert typeset(parse(text).root, letters=letters) == expected


@pytest.mark.parametrize(
    "text",
    ["-a^2/3 + sqrt(x^2 + y^2)/(1 - sin(q1)^2)", "atan2(y, x) - asin(x)*acos(x)*arctan(abs(x))", "theta1*s2'/J_g0_32",
     "x_y_z + Lambda", "transpose(inverse(J)) @ M - k*inverse(A + B) @ cross(r, F)",
     "sum(i, 1, 3, m[i]*transpose(J_v[i]) @ g) + [[skew(r), log(R_x(a))], [Tra_z(l), 0]] = x[i+1, n]",
     "(1 + 2)*3*4/5/6", "a/(b + c + d + e + f + g + h + i + j + k + l + m + n + o)"],
)  # fmt: skip
def test_what_is_typeset_is_valid(text):
    source = typeset(parse(text).root)
    assert mathml.mathml([source], displayed=False)[source] is not None


def test_what_is_marked_is_set_apart_with_its_sign():
    node = parse("a - b*c + d").root
    assert typeset(node, {node.terms[1][1]}) == 'italic("a") differs(- italic("b") italic("c")) + italic("d")'


def test_brackets_within_brackets_are_two():
    assert typeset(parse("arctan(19/60)").root) == "arctan \\( (19) / (60)\\)"


def test_a_matrix_is_valid():
    node = parse("[[-s1, 1/2*c12], [atan2(y, x), 0]]").root
    text = typeset(node, {node.arguments[0].arguments[1]})
    assert text.count("differs(") == 1
    assert mathml.mathml([text], displayed=False)[text] is not None


def test_a_line_of_text_has_greek_letters_and_low_digits():
    assert linear("-l4*cos(theta12)*P_ex^2 + J_31") == "-l₄ cos(θ₁₂) P_ex^2 + J₃₁"
