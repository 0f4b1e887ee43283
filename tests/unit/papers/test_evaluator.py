"""The evaluator: values against Python's, what is refused and with which words, and each limit at, below and above."""

import math
from pathlib import Path

import pytest
from support.hostile_expressions import FUNCTIONS, SCOPE, VALUES, Length

from runner.papers.expressions.evaluator import LONGEST, ExpressionError, OperationBudget, Scope, parse


def value(text, operations=1_000_000):
    return SCOPE.evaluate(text, OperationBudget(operations))


def refusal(text, operations=1_000_000):
    with pytest.raises(ExpressionError) as error:
        value(text, operations)
    return error.value


@pytest.mark.parametrize(
    "text",
    [
        "1 - 2 - 3*4/5 + -x", "2**3**2 - -n", "-n**2", "(x + 1)*(x - 1)/n", "2**-1", "1e3", "10**18*10.0", "-(-n)",
        "'a' + 'b'", "'a' 'b'", "[1] + [n, 'x']", "(1, [2], {'a': n})", "()", "{'a': 1}['a']", "items[0]", "items[-1]",
        "[[1, 2], 3][0][1]", "x < n < 9", "x == 2.5", "n != 7", "word == 'wide'", "word != 1", "nothing is None",
        "x is not None", "'wi' in word", "'three' in items", "'no' not in items", "flag and x > 1 or not flag",
        "1 if n > x else 1/0", "flag or 1/0 > 1", "not (n > x)", "items + items + [x]",
        "total(many, start=x)", "pair(*[1, 2])", "pair(1, *['b'])", "'%s: %d of %.2f, %g%%, %e' % (word, n, x, x, x)",
        "'%+5.1f|%-3d|%s' % (x, n, flag)", "'100%%' % ()", "True", "None", "'''a'''", "apply(largest, [1, n])",
        "apply(measure(n), x)", "length.metres*2", "length.longer(2).metres", "(length + length).metres",
        "(-length).metres", "length < length.longer(by=1)",
    ],
)  # fmt: skip
def test_values_are_those_of_python(text):
    assert value(text) == eval(text, {"__builtins__": {}}, FUNCTIONS | VALUES)


def test_a_name_may_have_dots():
    assert value("arm.mass + 1") == 4.25


def test_lines_are_one():
    assert value("pair(\n  x,\r\n\tn\n)") == [2.5, 7]
    assert value("'''a\nb'''") == "a b"


@pytest.mark.parametrize(
    ("text", "position", "reason"),
    [
        ("", 1, "ends too early"),
        ("x +", 4, "ends too early"),
        ("(x", 1, "'(' was never closed"),
        ("x n", 3, "invalid syntax"),
        ("x = 1", 3, "invalid syntax"),
        ("x; n", 2, "invalid syntax"),
        ("import os", 1, "invalid syntax"),
        ("x # n", 3, "a comment is not allowed"),
        ("pair(x) # )", 9, "a comment is not allowed"),
        ("x\0", 2, "null byte"),
        ("'\ud800'", 1, "contains a character that is not allowed"),
        ("y", 1, "no name 'y'; names: total, pair"),
        ("1 + totl([x])", 5, "no name 'totl' (did you mean total?)"),
        ("ärm + arm.mas", 1, "no name 'ärm'"),
        ("'ä' + arm.mas", 7, "no name 'arm.mas' (did you mean arm.mass?)"),
        ("__import__('os')", 1, "no name '__import__'"),
        ("__builtins__", 1, "no name '__builtins__'"),
        ("open('f')", 1, "no name 'open'"),
        ("x.__class__", 1, "a value of type float has no '__class__' that can be read"),
        ("x.real", 1, "a value of type float has no 'real'"),
        ("().__class__", 1, "a value of type tuple has no '__class__'"),
        ("word.format(x)", 1, "a value of type str has no 'format'"),
        ("items.append", 1, "a value of type list has no 'append'"),
        ("total.__globals__", 1, "a value of type function has no '__globals__'"),
        ("measure(1).func", 1, "a value of type partial has no 'func'"),
        ("length.longer.__self__", 1, "a value of type method has no '__self__'"),
        ("length.secret", 1, "a value of type Length has no 'secret' that can be read; there are: metres, longer"),
        ("length.open()", 1, "has no 'open'"),
        ("measure(1)(2)", 1, "only named functions can be called"),
        ("x(1)", 1, "no name 'x'"),
        ("length.metres()", 1, "this is not a function"),
        ("f'{x}'", 1, "a text with braces is not allowed"),
        ("1 if flag else f'{x}'", 16, "a text with braces is not allowed"),
        ("flag or [y for y in items]", 9, "a loop is not allowed"),
        ("lambda: x", 1, "a function is not allowed"),
        ("[y for y in items]", 1, "a loop is not allowed"),
        ("(y := 1)", 2, "an assignment is not allowed"),
        ("items[0:1]", 7, "a range is not allowed"),
        ("{1, 2}", 1, "'{1, 2}' is not allowed"),
        ("~(" + "n+" * 900 + "n)", 1, "'~(n+n+n"),
        ("b'a'", 1, "cannot hold a value of type bytes"),
        ("2j", 1, "cannot hold a value of type complex"),
        ("...", 1, "cannot hold a value of type ellipsis"),
        ("(-8)**0.5", 7, "not a real number"),
        ("3 % 2", 5, "cannot compute with int and int"),
        ("x // n", 6, "cannot compute with float and int"),
        ("n << 2", 6, "cannot compute with int and int"),
        ("x @ n", 5, "has no value: unsupported operand type(s) for @"),
        ("word * 3", 8, "cannot compute with str and int"),
        ("items * 3", 9, "cannot compute with list and int"),
        ("flag + 1", 8, "cannot compute with bool and int"),
        ("() + ()", 6, "cannot compute with tuple and tuple"),
        ("length + 1", 10, "has no value: unsupported operand"),
        ("length < 1", 1, "has no value: '<' not supported"),
        ("-word", 1, "a sign needs a number after it; found str"),
        ("-flag", 1, "a sign needs a number after it; found bool"),
        ("not x", 5, "float is neither true nor false"),
        ("flag and x", 10, "float is neither true nor false"),
        ("1 if items else 2", 6, "list is neither true nor false"),
        ("x < word", 1, "float and str cannot be compared like this"),
        ("items == items", 1, "list and list cannot be compared like this"),
        ("n/0", 3, "division by zero"),
        ("x - n/(n - 7)", 8, "division by zero"),
        ("9.0**9**9", 6, "has no value: Numerical result out of range"),
        ("items[3]", 1, "no item 3 of 3"),
        ("items[flag]", 1, "no item True of a value of type list"),
        ("word[0]", 1, "no item 0 of a value of type str"),
        ("table['d']", 1, "has no 'd'; there are: a, b"),
        ("{nothing: 1}", 2, "a key of a mapping must be a string or a number"),
        ("{**table}", 1, "a key of a mapping must be a string or a number"),
        ("pair(**table)", 1, "two stars"),
        ("pair(first=1, first=2)", 1, "a name twice"),
        ("pair(*x)", 6, "a star needs a list after it; found float"),
        ("pair(1, 2, 3)", 1, "TypeError: pair() takes"),
        ("'%s' % total", 8, "%s does not show function"),
        ("'%s' % (items,)", 8, "%s does not show list"),
        ("'%d' % word", 8, "%d does not show str"),
        ("'%s' % ()", 8, "1 of the forms"),
        ("'%r' % x", 8, "0 of the forms"),
        ("'%(a)s' % table", 11, "0 of the forms"),
        ("'%*d' % (9, 1)", 9, "0 of the forms"),
        ("'%999d' % n", 11, "0 of the forms"),
        ("'%.999f' % x", 12, "0 of the forms"),
        ("'%' % ()", 7, "0 of the forms"),
    ],
    ids=lambda part: ascii(part[:40]) if isinstance(part, str) else None,
)
def test_what_is_refused_is_told_with_its_position(text, position, reason):
    error = refusal(text)
    assert reason in error.reason
    assert error.position == position


@pytest.mark.parametrize(
    ("text", "kind"),
    [("a_path()", "PosixPath"), ("a_run()", "Run"), ("a_frame()", "frame"), ("a_module()", "module"),
     ("a_nest()", "Run"), ("an_array()", "memoryview"), ("pair(a_run())", "Run"), ("apply(a_path)", "PosixPath"),
     ("[1, a_module()]", "module"), ("a_nest()[0]", "Run"), ("apply(apply, a_frame)", "frame")],
)  # fmt: skip
def test_what_is_not_listed_is_never_handed_out(text, kind):
    assert f"cannot hold a value of type {kind}" in refusal(text).reason


def test_a_value_of_a_name_is_looked_at_too():
    with pytest.raises(ExpressionError, match=r"cannot hold a value of type .*Path"):
        Scope({}, {"folder": Path("run")}).evaluate("folder", OperationBudget())


def test_values_of_handed_classes_pass_but_are_not_worked_with():
    scope = Scope({"pair": FUNCTIONS["pair"]}, {"folder": Path("run")}, handed=(Path,))
    assert scope.evaluate("pair(folder)", OperationBudget()) == [Path("run"), None]
    for text in ("folder.name", "folder/'x'", "folder == folder", "'%s' % folder", "-folder"):
        with pytest.raises(ExpressionError):
            scope.evaluate(text, OperationBudget())


@pytest.mark.parametrize(
    ("below", "above", "reason"),
    [
        ("'" + "w" * (LONGEST - 2) + "'", "'" + "w" * (LONGEST - 1) + "'", "has 10001 characters"),
        ("long + '" + "w" * 1000 + "'", "long + '" + "w" * 1001 + "'", "a string or list of 10001"),
        ("'%s' % long + '" + "w" * 1000 + "'", "'%s%s' % (long, long)", "a string of more than 10000 characters"),
        ("[*many, " + "1, " * 1000 + "]", "[*many, " + "1, " * 1001 + "]", "more than 10000 items"),
        ("[many] + [" + "1, " * 999 + "]", "[many] + [" + "1, " * 1000 + "]", "more than 10000 items"),
        ("[many, " + "1, " * 999 + "]", "[many, " + "1, " * 1000 + "]", "more than 10000 items"),
        ("many + [" + "1, " * 1000 + "]", "many + [" + "1, " * 1001 + "]", "a string or list of 10001"),
        ("pair(many)", "pair(many, many)", "more than 10000 items"),
        ("9223372036854775807", "9223372036854775808", "more than 63 bits"),
        ("2**62 + (2**62 - 1)", "2**62 + 2**62", "more than 63 bits"),
        ("-2**62 - (2**62 - 1)", "-2**62 - 2**62", "more than 63 bits"),
        ("2**62", "2**63", "more than 63 bits"),
        ("3**39", "3**40", "more than 63 bits"),
        ("(-2)**62", "(-2)**63", "more than 63 bits"),
        ("1**9**9", "10**9**9", "more than 63 bits"),
        ("9" * 18, "9" * 4301, "Exceeds the limit"),
        ("n+" * 1000 + "n", "n+" * 1001 + "n", "more than 1000 operations in a row"),
        ("-" * 60 + "n", "-" * 61 + "n", "nested more than 60 deep"),
        ("[" * 60 + "n" + "]" * 60, "[" * 61 + "n" + "]" * 61, "nested more than 60 deep"),
        ("pair(" * 60 + "n" + ")" * 60, "pair(" * 61 + "n" + ")" * 61, "nested more than 60 deep"),
        ("(" * 60 + "n" + "+1)" * 60, "(" * 61 + "n" + "+1)" * 61, "nested more than 60 deep"),
        ("(1+" * 60 + "n" + ")" * 60, "(1+" * 61 + "n" + ")" * 61, "nested more than 60 deep"),
        ("1 if flag else " * 60 + "n", "1 if flag else " * 61 + "n", "nested more than 60 deep"),
    ],
    ids=lambda part: ascii(part[:30]),
)
def test_each_limit_at_and_above(below, above, reason):
    value(below)
    assert reason in refusal(above).reason


def test_nested_lists_that_double_are_refused_where_they_are_too_large():
    scope, doubled = SCOPE, [1.0]
    for level in range(1, 20):
        scope = Scope({}, {"a": doubled})
        count = 2 ** (level + 1) - 2 + 2**level  # items of the lists and of those in them
        if count > LONGEST:
            break
        doubled = scope.evaluate("[a, a]", OperationBudget())
    assert level == 12
    with pytest.raises(ExpressionError, match="more than 10000 items"):
        scope.evaluate("[a, a]", OperationBudget())


@pytest.mark.parametrize(("text", "cost"), [("x", 1), ("x + n", 2 + 1), ("[x, n]", 3 + 2), ("many[0]", 2 + 1 + 9000)])
def test_each_part_and_each_item_takes_one_operation(text, cost):
    value(text, cost)
    assert f"the expressions of a file take more than {cost - 1} operations" in refusal(text, cost - 1).reason


def test_a_budget_is_shared_by_the_expressions_of_a_file():
    budget = OperationBudget(10)
    for _ in range(5):
        SCOPE.evaluate("-x", budget)
    with pytest.raises(ExpressionError, match="more than 10 operations"):
        SCOPE.evaluate("x", budget)


def test_infinity_and_nan_are_numbers():
    assert value("1e999") == math.inf
    assert math.isnan(value("1e999 - 1e999"))


def test_numbers_stand_for_what_the_scope_makes_of_them():
    scope = Scope({}, {"a": Length(1.0)}, {Length: ("metres",)}, number=Length)
    assert scope.evaluate("-(a + 2) + 4.5", OperationBudget()) == Length(1.5)


def test_a_tree_is_made_once():
    assert parse("x + n") is parse("x + n")
