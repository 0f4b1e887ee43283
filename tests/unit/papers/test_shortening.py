"""Shortened expressions: every marked term stays."""

from runner.papers.expressions.difference import difference
from runner.papers.expressions.parser import parse
from runner.papers.expressions.tree import ELLIPSIS, holds, shorten_expression, size, symbols

LONG = "a*b*c*d*e*f*g + l4*cos(q1)*(c1*c2*c3 + s1*s2*s3 + c4*s4) - h*i*j*k*l*m*n + o*p"


def test_dots_stand_once_for_neighbours_in_which_nothing_is_marked():
    node = parse(LONG).root
    marked = difference(node, parse(LONG.replace("q1", "theta1")).root).first
    assert list(symbols(shorten_expression(node, marked))) == [ELLIPSIS, "l4", "cos", "q1", f"({ELLIPSIS})", ELLIPSIS]


def test_of_many_marked_terms_the_first_are_shown():
    node = parse(" + ".join(f"x{i}*y{i}" for i in range(20))).root
    short = shorten_expression(node, {term for _, term in node.terms})
    assert list(symbols(short)) == ["x0", "y0", "x1", "y1", "x2", "y2", ELLIPSIS]


def test_short_parts_stay():
    node = parse("a*b + c").root
    assert shorten_expression(node, frozenset()) is node


def test_what_is_left_still_holds_every_mark_of_few():
    node = parse(LONG).root
    marked = difference(node, parse(LONG.replace("q1", "theta1").replace("o*p", "o")).root).first
    short = shorten_expression(node, marked)
    assert all(holds(short, {each}) for each in marked)
    assert size(short) < size(node)
