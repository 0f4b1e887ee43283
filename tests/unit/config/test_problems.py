"""Collection of problems: what checks give, what they find, and the report of all at once."""

import pytest

from runner.base.errors import ConfigError
from runner.config.parsing import Problems, require


def _fail(*problems):
    raise ConfigError(problems)


def test_a_check_gives_its_value_and_a_failed_one_none():
    problems = Problems()
    assert problems.attempt(lambda a, b: a + b, 1, 2) == 3
    assert problems.attempt(_fail, "a: wrong") is None
    assert problems.found == ["a: wrong"]


@pytest.mark.parametrize("method", ["attempt", "recall"])
def test_a_check_without_all_its_parts_is_left_out(method):
    problems = Problems()
    assert getattr(problems, method)(_fail, "a: wrong", None) is None
    assert problems.found == []


def test_the_report_has_every_problem_in_order():
    problems = Problems()
    problems.report()
    problems.attempt(_fail, "a: wrong", "b: wrong")
    problems.attempt(_fail, "c: wrong")
    with pytest.raises(ConfigError) as caught:
        problems.report()
    assert list(caught.value.problems) == ["a: wrong", "b: wrong", "c: wrong"]


def test_only_a_value_is_required():
    assert require(0) == 0
    with pytest.raises(AssertionError):
        require(None)
