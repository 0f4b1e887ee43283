"""Ranges: what they hold, where a number lies, and their words."""

import math

import numpy as np
import pytest

from runner.schema.bound import Bound, Range


def test_ends_belong_to_a_range_and_what_is_missing_does_not():
    values = np.array([0.9, 1.0, 1.5, 2.0, 2.1, math.nan])
    assert Range(1.0, 2.0).holds(values).tolist() == [False, True, True, True, False, False]
    assert [Range(1.0, 2.0).holds(float(value)) for value in values] == [False, True, True, True, False, False]
    assert Range(high=np.array([1.0, 3.0])).exceeded(2.0).tolist() == [True, False]


def test_an_open_end_takes_every_finite_number():
    assert Bound(min=0.0).range.holds(np.array([1e308, math.inf, -1.0])).tolist() == [True, False, False]
    assert Range(0.0, math.inf).holds(math.inf)


def test_no_value_counts_as_above_every_number():
    below_and_above = [Range(1.0, 2.0).verdict(value) for value in (0.5, 1.0, 3.0, None)]
    assert below_and_above == ["below", "within", "above", "above"]
    assert Range(1.0, math.inf).verdict(None) == "within"


@pytest.mark.parametrize(
    ("ends", "text"),
    [((1.0, 2.5), "1.0 to 2.5"), ((None, 2.5), "at most 2.5"), ((1.0, None), "at least 1.0"), ((None, None), "none")],
)
def test_a_range_in_words(ends, text):
    assert Range.between(*ends).text(str) == text
    assert Range.between(1.0, 2.5).text(str, lambda low, high: f"{low}-{high}") == "1.0-2.5"
