"""Dates of bounds: the first date of each value, and what was set after the result."""

import re

import pytest

from runner.config.judgement import Bound
from runner.statistics.spec.history import ends_of, merge_histories, set_after, settings, today

LOW, HIGH = Bound(max=1.0), Bound(min=0.5, max=2.0)


def test_a_history_begins_with_the_bound_and_its_date():
    assert settings({"a": LOW, "b": None}, "2026-01-02") == {
        "a": [["2026-01-02", [None, 1.0]]],
        "b": [["2026-01-02", [None, None]]],
    }
    assert re.fullmatch(r"\d{4}-\d{2}-\d{2}", today())


def test_of_equal_values_the_first_date_stays():
    days = ("2026-01-01", "2026-01-02", "2026-01-03")
    merged = merge_histories(*(settings({"a": bound}, day) for bound, day in zip((LOW, HIGH, LOW), days, strict=True)))
    assert merged == {"a": [["2026-01-01", ends_of(LOW)], ["2026-01-02", ends_of(HIGH)]]}


@pytest.mark.parametrize(
    ("bound", "found"),
    [(LOW, ("", ())), (HIGH, ("2026-01-02", [ends_of(LOW)])), (Bound(max=9.0), ("", ()))],
)
def test_only_a_later_value_is_set_after_the_result(bound, found):
    history = [["2026-01-01", ends_of(LOW)], ["2026-01-02", ends_of(HIGH)]]
    assert set_after(history, ends_of(bound)) == found
