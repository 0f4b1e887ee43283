"""Conditions are tried with changed values; numbers that are typed in findings are reported."""

import pytest

from runner.papers.study.check import never_failing, typed_numbers
from runner.papers.study.measured import Measured
from runner.papers.study.prose import ProseError, read_chapter

NAMES = {
    "number": lambda value: Measured("number", value, "m"),
    "numbers": lambda: [Measured("one", 1.0, "m"), Measured("two", 2.0, "m")],
    "less": lambda values, bound: [each < bound for each in values],
}
CHAPTER = """\
# Title

{% set a = number(2.0) %}
{% set b = numbers() %}

::: finding Title
Words.
holds: CONDITION
:::
"""


def told_of(condition):
    return never_failing("one.md", read_chapter("one.md", CHAPTER.replace("CONDITION", condition), NAMES))


@pytest.mark.parametrize("condition", ["a > 1", "a < 1e2", "a.near(2, 0.1)", "less(b, 3)", "a < 2 * b[1]"])
def test_a_condition_that_some_change_refutes_is_good(condition):
    assert told_of(condition) == []


@pytest.mark.parametrize("condition", ["a > -1e9", "number(2.0) > 1", "less(b, 1e9)", "less([b[0], number(1.0)], 3)"])
def test_a_condition_that_nothing_refutes_is_told(condition):
    (told,) = told_of(condition)
    assert told.startswith(f"one.md:8: holds: {condition}: no change of a named value makes it fail")


def test_a_list_of_conditions_is_one_each_and_an_empty_one_none():
    with pytest.raises(ProseError, match=r"one.md:8: holds: \[\]: gives list, no condition"):
        told_of("[]")


def test_numbers_typed_in_a_finding_are_told():
    text = CHAPTER.replace("Words.", "It takes 5 s and {{ a }}\nof claim 3, $2 x$, 0.1 kg and\n7.").replace("a", "a")
    found = [*typed_numbers("one.md", text, {"0.1 kg"})]
    assert [line.split(" a number")[0] for line in found] == ["one.md:7: 5 s:", "one.md:9: 7:"]
    assert [*typed_numbers("one.md", text.replace("::: finding", "::: stands"), {"0.1 kg"})] == found
