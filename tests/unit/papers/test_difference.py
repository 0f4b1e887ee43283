"""Differences of two expressions: terms, signs and exchanged symbols."""

import pytest

from runner.papers.expressions.difference import difference
from runner.papers.expressions.parser import parse
from runner.papers.expressions.typesetting import typeset


def found(first, second):
    return difference(parse(first).root, parse(second).root)


def told(nodes):
    return {typeset(node) for node in nodes}


def shown(*texts):
    return {typeset(parse(text).root) for text in texts}


@pytest.mark.parametrize(
    ("first", "second"),
    [("a + b*c", "c*b + a"), ("-(a - b)^2", "-(a - b)^2"), ("2.0*sin(x)", "2*sin( x )"), ("a/b/c", "a/c/b")],
)
def test_what_is_equal_but_for_order_and_white_space_does_not_differ(first, second):
    each = found(first, second)
    assert (each.first, each.second) == (frozenset(), frozenset())


@pytest.mark.parametrize(
    ("first", "second", "left", "right"),
    [
        ("l4*cos(q1)*(a + b)", "l4*cos(theta1)*(a + b)", {"q1"}, {"theta1"}),
        ("a*b + c*d - e*f", "a*b - e*f", {"c*d"}, set()),
        ("135*s2 + sqrt(23961)*c", "135*s2 + 2*sqrt(3961)*c", {"23961"}, {"2", "3961"}),
        ("-1/10*s56 + c5", "-1/10*s56 + 1/10*c5", set(), {"1", "10"}),
        ("c4*s6 + theta6*c4*c6", "c4*s6", {"theta6*c4*c6"}, set()),
        ("atan(a/b)", "atan2(a, b)", {"atan(a/b)"}, {"atan2(a, b)"}),
        ("arctan(a/(b - c))", "atan2(a, b + c)", {"c"}, {"c"}),
        ("asin(a/b)", "atan2(a, b)", {"asin(a/b)"}, {"atan2(a, b)"}),
    ],
)
def test_only_what_the_other_lacks_is_named(first, second, left, right):
    each = found(first, second)
    assert told(each.first) == shown(*left)
    assert told(each.second) == shown(*right)


def test_a_term_with_the_other_sign_differs():
    each = found("p4*x - p3*y", "p4*x + p3*y")
    assert told(each.first) == told(each.second) == shown("p3*y")


def test_exchanged_symbols_are_counted():
    each = found("l4*cos(q1) + l5*sin(q2) - l4*sin(q1)", "l4*cos(theta1) + l5*sin(theta2) - l4*sin(theta1)")
    assert each.symbols_alone
    assert each.exchanged == {("q1", "theta1"): 2, ("q2", "theta2"): 1}


@pytest.mark.parametrize(
    ("first", "second"), [("a + b", "a - b"), ("a + b + c", "a + b"), ("2*a", "3*a"), ("a", "sin(a)")]
)
def test_more_than_exchanged_symbols_is_told_apart(first, second):
    assert not found(first, second).symbols_alone


def test_expressions_with_nothing_in_common_differ_as_a_whole():
    first, second = parse("cos(q1)*sin(q2)").root, parse("-p + 3").root
    each = difference(first, second)
    assert (each.first, each.second) == ({first}, {second})
