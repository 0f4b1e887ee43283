"""Expressions in double braces within a string: where each begins and ends, and what is in their place."""

import pytest

from runner.papers.expressions.evaluator import OperationBudget, Scope
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.insertions import fill, insertions

SCOPE = Scope({"of": lambda group: group["a"]["b"]}, {"x": 2.5, "group": {"a": 1}})


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("plain { and } and }}", []),
        ("{{ x }}", ["{{ x }}"]),
        ("a {{ x }}b{{ x}}", ["{{ x }}", "{{ x}}"]),
        ('{{ of({"a": {"b": 1}}) }}', ['{{ of({"a": {"b": 1}}) }}']),
        ("{{ {'a': {'b': {}}}}} c", ["{{ {'a': {'b': {}}}}}"]),
        ('{{ "}}" + "\\"}}" }} c', ['{{ "}}" + "\\"}}" }}']),
        ("{{ '{' }}", ["{{ '{' }}"]),
    ],
)
def test_an_expression_ends_where_its_own_braces_do(text, found):
    assert [text[start:stop] for start, stop in insertions(text)] == found


@pytest.mark.parametrize("text", ["a {{ x", "{{ x }", "{{ {'a': 1 }}"])
def test_one_that_is_not_closed_is_told_with_its_place(text):
    with pytest.raises(ExpressionError, match=r"\{\{ is not closed") as told:
        list(insertions(text))
    assert told.value.position == text.index("{{") + 1


def test_values_stand_in_their_place():
    assert fill('{{ x }} and {{ of({"a": {"b": 7}}) }}.', SCOPE, OperationBudget()) == "2.5 and 7."
    assert fill("{{ x }}{{ group.a }}", SCOPE, OperationBudget(), lambda value: f"<{value}>") == "<2.5><1>"
    assert fill("nothing", SCOPE, OperationBudget()) == "nothing"
