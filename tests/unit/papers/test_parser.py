"""Reader of printed arithmetic: its tree against brackets and signs, positions in messages, limits, order of names."""

import pytest

from runner.papers.expressions.grammar import LONGEST, ExpressionError
from runner.papers.expressions.parser import parse
from runner.papers.expressions.tree import Call, Name, Power, Product, Sum, WrittenNumber, parts


def names(node):
    return [node] if isinstance(node, Name) else [name for part in parts(node) for name in names(part)]


@pytest.mark.parametrize(
    ("text", "position", "reason"),
    [
        ("", 1, "ends too early"),
        ("   ", 4, "ends too early"),
        ("sin(q1", 4, "'(' was never closed"),
        ("(q1*(q2 + 1)", 1, "'(' was never closed"),
        ("q1)", 3, "unmatched ')'"),
        ("()", 1, "is not arithmetic"),
        ("q1 +", 5, "ends too early"),
        (" q1^2 * ", 8, "ends too early"),
        ("q1 * / q2", 6, "is not an expression"),
        ("q1^2 * / q2", 8, "is not an expression"),
        ("2 q1", 3, "a product needs its '*'"),
        ("q1' q2", 5, "a product needs its '*'"),
        ("(q1) q2", 6, "a product needs its '*'"),
        ("q1 if q2 else q3", 4, "'if' follows without a sign"),
        ("not q1", 5, "'q1' follows without a sign"),
        ("2q1", 1, "is not an expression"),
        ("(q1)(q2)", 1, "a product needs its '*'"),
        ("2(q1)", 1, "is not arithmetic"),
        ("c1(q2)", 1, "'c1' is not a function"),
        ("sine(q1)", 1, "did you mean sin?"),
        ("q2^3 + sine(q1)", 8, "did you mean sin?"),
        ("exec(q1)", 1, "is not a function that can be called"),
        ("sin + q1", 1, "is not arithmetic"),
        ("sin(*q1)", 5, "is not arithmetic"),
        ("sin(**q1)", 1, "is not arithmetic"),
        ("q1 // q2", 1, "is not arithmetic"),
        ("q1.real", 1, "is not arithmetic"),
        ("q1 + q2...", 8, "the text is lost here"),
        ("__import__('os').system('ls')", 12, "not a sign of arithmetic"),
        ("(lambda: 1)()", 8, "':' is not a sign of arithmetic"),
        ("q1[0.5]", 1, "the places of a quantity are letters, digits, or as i+1 and i-1"),
        ("q[i*2]", 1, "the places of a quantity"),
        ("sin[1]", 1, "is not arithmetic"),
        ("(a + b)[1]", 1, "is not arithmetic"),
        ("a*[]", 3, "is not arithmetic"),
        ("[[a], []]", 7, "a row of a matrix needs an element"),
        ("[a] b", 5, "a product needs its '*'"),
        ("sum(i, 1, n, a)", 1, "a sum is sum(i, 1, 3, ...)"),
        ("sum(i, a)", 1, "sum takes 4 argument(s), not 2"),
        ("a = b + (c = d)", 10, "is not arithmetic"),
        ("a < b", 3, "not a sign of arithmetic"),
        ("q1 # q2", 4, "'#' is not a sign of arithmetic"),
        ("q1\\\n+ q2", 3, "is not a sign of arithmetic"),
        ("'a'*9", 1, "not a sign of arithmetic"),
        ("q1\0", 3, "not a sign of arithmetic"),
        ("q1 + \ud800", 6, "not a sign of arithmetic"),
        ("q1, q2", 1, "is not arithmetic"),
        ("sin(q1, q2)", 1, "sin takes 1 argument(s), not 2"),
        ("atan2(q1)", 1, "atan2 takes 2 argument(s), not 1"),
        ("1e999", 1, "is too large"),
        ("1.2.3", 4, "is not an expression"),
        ("True", 1, "is not arithmetic"),
        ("2j", 1, "is not arithmetic"),
        ("0x10", 1, "is not arithmetic"),
        ("1_000", 1, "is not arithmetic"),
        ("a + … b", 5, "the text is lost here"),
        ("-" * 61 + "1", 62, "nested more than 60 deep"),
        ("sin(" * 61 + "1" + ")" * 61, 245, "nested more than 60 deep"),
        ("(" * 61 + "1" + "+1)" * 61, 64, "nested more than 60 deep"),
    ],
    ids=lambda part: ascii(part[:40]) if isinstance(part, str) else None,
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
    assert first.startswith("position 21: '$' is not a sign of arithmetic")
    assert excerpt[mark.index("^")] == "$"


def test_in_a_long_text_the_message_shows_the_neighbourhood():
    with pytest.raises(ExpressionError) as error:
        parse("q1 + " * 200 + "?" + " + q1" * 200)
    _, excerpt, mark = str(error.value).splitlines()
    assert excerpt[mark.index("^")] == "?"
    assert len(excerpt) < 80


def test_an_expression_that_is_too_long_is_refused():
    assert len(names(parse("q" * LONGEST).root)) == 1
    with pytest.raises(ExpressionError, match=f"has {LONGEST + 1} characters; allowed: up to {LONGEST}"):
        parse("q" * (LONGEST + 1))


@pytest.mark.parametrize(("open_", "close"), [("-", ""), ("sin(", ")"), ("(", "+1)")])
def test_sixty_levels_are_read(open_, close):
    parse(open_ * 60 + "1" + close * 60)


def test_a_thousand_operations_in_a_row_are_read():
    assert len(names(parse("q+" * 1000 + "q").root)) == 1001
    with pytest.raises(ExpressionError, match="more than 1000 operations in a row"):
        parse("q+" * 1001 + "q")


def test_names_stand_in_order_with_their_place():
    found = names(parse("s2'*l_4 + sin(theta1)^k\n- µ'^2*x").root)
    places = [("s2'", 0), ("l_4", 4), ("theta1", 14), ("k", 22), ("μ'", 26), ("x", 31)]
    assert [(name.name, name.index) for name in found] == places


A, B, C = (lambda index, name=name: Name(name, index) for name in "abc")


@pytest.mark.parametrize(
    ("text", "root"),
    [
        ("a - b + c", Sum(((False, A(0)), (True, B(4)), (False, C(8))), 0)),
        ("a - (b + c)", Sum(((False, A(0)), (True, Sum(((False, B(5)), (False, C(9))), 5))), 0)),
        ("(a - b) + c", Sum(((False, Sum(((False, A(1)), (True, B(5))), 1)), (False, C(10))), 0)),
        ("a/b*c", Product(((False, A(0)), (True, B(2)), (False, C(4))), 0)),
        ("(a/b)*c", Product(((False, Product(((False, A(1)), (True, B(3))), 1)), (False, C(6))), 0)),
        ("a/(b*c)", Product(((False, A(0)), (True, Product(((False, B(3)), (False, C(5))), 3))), 0)),
        ("-a*b", Sum(((True, Product(((False, A(1)), (False, B(3))), 1)),), 0)),
        ("(-a)*b", Product(((False, Sum(((True, A(2)),), 1)), (False, B(5))), 0)),
        ("-a + b", Sum(((True, A(1)), (False, B(5))), 0)),
        ("(-a) + b", Sum(((False, Sum(((True, A(2)),), 1)), (False, B(7))), 0)),
        ("c + -a*b", Sum(((False, C(0)), (False, Product(((False, Sum(((True, A(5)),), 4)), (False, B(7))), 4))), 0)),
        ("c + (-a*b)", Sum(((False, C(0)), (False, Sum(((True, Product(((False, A(6)), (False, B(8))), 6)),), 5))), 0)),
        ("+a", A(1)),
        ("[a, b]", Call("matrix", (Call("row", (A(1),), 1), Call("row", (B(4),), 4)), 0)),
        ("[[a, (b - c)]]", Call("matrix", (Call("row", (A(2), Sum(((False, B(6)), (True, C(10))), 6)), 1),), 0)),
        ("a = b", Call("=", (A(0), B(4)), 0)),
        ("a*x[i - 1, n]", Product(((False, A(0)), (False, Name("x[i-1,n]", 2))), 0)),
        ("a^b^c", Power(A(0), Power(B(2), C(4), 3), 1)),
        ("(a^b)**c", Power(Power(A(1), B(3), 2), C(7), 5)),
        ("-a^2", Sum(((True, Power(A(1), WrittenNumber("2", 3), 2)),), 0)),
        ("a^-b", Power(A(0), Sum(((True, B(3)),), 2), 1)),
        ("\n (atan2(a, -1.50e+0))", Call("atan2", (A(9), Sum(((True, WrittenNumber("1.50e+0", 13)),), 12)), 3)),
    ],
)
def test_brackets_and_signs_are_where_they_were(text, root):
    assert parse(text).root == root
