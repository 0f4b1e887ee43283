"""Strings of quantities: digits, units, ranges and missing values."""

import math

import pytest

from runner.base.quantities import (
    above_rounding,
    digits_between,
    format_duration,
    format_range,
    label_with_unit,
    number,
    quantity,
    spread,
    with_interval,
    with_powers,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (0.0, "0"),
        (1.0, "1"),
        (1.234567, "1.23"),
        (-0.0734567, "-0.0735"),
        (0.01, "0.01"),
        (0.00999, "9.99·10⁻³"),
        (9e-3, "9·10⁻³"),
        (6e-5, "6·10⁻⁵"),
        (8.734e-3, "8.73·10⁻³"),
        (-8.734e-3, "-8.73·10⁻³"),
        (999.6, "1000"),
        (3875.47, "3875"),
        (9999.0, "9999"),
        (1e4, "1·10⁴"),
        (417703.3, "4.18·10⁵"),
        (2.66e-15, "2.66·10⁻¹⁵"),
    ],
)
def test_numbers_have_three_digits_and_a_power_of_ten_where_it_helps(value, text):
    assert number(value) == text


def test_digits_can_be_asked_for():
    assert number(1.99999, 4) == "2"
    assert number(0.095123, 4) == "0.09512"


@pytest.mark.parametrize(
    ("unit", "text"), [("m", "2 m"), ("1", "2"), ("N^2 m^2 s", "2 N² m² s"), ("m/s^2", "2 m/s²"), ("N m", "2 N m")]
)
def test_units_are_set_with_their_powers(unit, text):
    assert quantity(2.0, unit) == text


def test_a_missing_value_keeps_its_unit():
    assert quantity(None, "s") == "– s"


@pytest.mark.parametrize(
    ("value", "text"),
    [(2.66e-15, "0 (rounding)"), (-5.6e-17, "0 (rounding)"), (0.0, "0 m"), (2e-12, "2·10⁻¹² m"), (None, "– m")],
)
def test_what_is_of_the_size_of_rounding_errors_is_told_as_such(value, text):
    assert above_rounding(value, "m") == text


@pytest.mark.parametrize(
    ("values", "median", "low", "high", "text"),
    [
        ([1.5], 1.5, 1.5, 1.5, "1.5 s"),
        ([1.5, 1.5], 1.5, 1.5, 1.5, "1.5 s"),
        ([1.5, 1.6, 2.8], 1.6, 1.5, 2.8, "1.60 s (1.50 to 2.80)"),
        ([1.5, 1.6, None], 1.6, 1.5, None, "1.60 s (1.50 to never)"),
        ([1.5, None, None], None, 1.5, None, "– s (1.50 to never)"),
        ([0.101, 0.102, 0.11], 0.102, 0.101, 0.11, "0.102 s (0.101 to 0.110)"),
        ([0.09, 0.091, 0.12], 0.091, 0.09, 0.12, "91.0 ms (90.0 to 120)"),
        ([0.0, 0.0, 0.12], 0.0, 0.0, 0.12, "0 s (0 to 0.120)"),
        ([0.0, 1e-17, 2e-9], 1e-17, 0.0, 2e-9, "0 (rounding) (0 to 2.00·10⁻⁹)"),
    ],
)
def test_spread_tells_the_range_over_the_repetitions(values, median, low, high, text):
    assert spread("s", median, low, high, len(values)) == text


@pytest.mark.parametrize(
    ("metric", "printed", "text"),
    [
        ((3.89e-4, 2.52e-4, 0.947), 9e-3, "0.389 mm (0.252 to 947)"),
        ((0.101, 0.0963, 0.107), 0.15, "0.101 m (0.0963 to 0.107)"),
        ((0.0735, 0.0734, 0.0738), 0.044, "73.5 mm (73.4 to 73.8)"),
        ((7.2e-7, 7.1e-7, 7.3e-7), 8e-4, "0.720 µm (0.710 to 0.730)"),
        ((7.2e-7, 7.1e-7, 7.3e-7), None, "0.720 µm (0.710 to 0.730)"),
    ],
)
def test_a_value_has_the_unit_of_the_printed_one_where_that_needs_no_power_of_ten(metric, printed, text):
    median, low, high = metric
    assert spread("m", median, low, high, 3, printed) == text


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.1, "m", "0.1 m"),
        (0.0999, "m", "99.9 mm"),
        (8.734e-3, "m", "8.73 mm"),
        (-3.9e-4, "m", "-0.39 mm"),
        (1e-5, "m", "0.01 mm"),
        (7.31e-6, "m", "7.31 µm"),
        (2.5e-7, "m", "0.25 µm"),
        (2e-9, "m", "2·10⁻⁹ m"),
        (0.091, "s", "91 ms"),
        (1.4, "s", "1.4 s"),
        (4e-6, "s", "4 µs"),
        (4.3e-6, "rad", "4.30·10⁻⁶ rad"),
        (math.nan, "m", "– m"),
    ],
)
def test_small_lengths_and_times_have_smaller_units(value, unit, text):
    assert quantity(value, unit) == text


@pytest.mark.parametrize(
    ("low", "high", "text"),
    [(0.0, 9e-3, "0 to 9 mm"), (0.007, 0.044, "7 to 44 mm"), (0.1, 0.15, "0.1 to 0.15 m"), (5e-3, 0.2, "5 to 200 mm")],
)
def test_both_ends_of_a_range_have_one_unit(low, high, text):
    assert format_range(low, high, "m") == text


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("above 1e+06 rad/s", "above 1·10⁶ rad/s"),
        ("value 0.00307, number 2.39e+16; 3.04e-17", "value 0.00307, number 2.39·10¹⁶; 0 (rounding)"),
        ("2.0e-3 m", "2·10⁻³ m"),
        ("run 58e16a47, mode1e3", "run 58e16a47, mode1e3"),
    ],
)
def test_numbers_in_messages_are_written_as_in_a_report(text, shown):
    assert with_powers(text) == shown


@pytest.mark.parametrize(
    ("value", "half", "texts"),
    [
        (299.973, 1.13, ("300.0", "± 1.1")),
        (250.68, 0.795, ("250.68", "± 0.80")),
        (9.5708, 0.048, ("9.571", "± 0.048")),
        (1234.5, 56.0, ("1234", "± 56")),
        (0.5, 0.0, ("0.500", "± 0.000")),
    ],
)
def test_an_estimate_has_as_many_decimals_as_its_interval(value, half, texts):
    assert with_interval(value, half) == texts


@pytest.mark.parametrize(("unit", "text"), [("1", "x"), ("m", "x (m)"), ("N^2 m^2 s", "x (N² m² s)")])
def test_a_label_carries_the_unit(unit, text):
    assert label_with_unit("x", unit) == text


@pytest.mark.parametrize(("low", "high"), [(371.1, 372.3), (0.5, 0.5), (1e-4, 2.0), (-3.0, -2.999), (0.0, 5.0)])
def test_so_many_digits_tell_values_apart_that_lie_between_two(low, high):
    places = [low + part * (high - low) for part in (0.0, 0.25, 0.5, 0.75, 1.0)]
    texts = [number(place, digits_between(low, high)) for place in places]
    assert len(set(texts)) == len(set(places))


def test_what_is_below_rounding_is_said_to_be_that():
    assert number(3.2e-18, rounding=1e-9) == "0 (rounding)"
    assert quantity(-4.4e-12, "%", rounding=1e-9) == "0 (rounding)"
    assert quantity(4.71e-3, "%") == "0.00471 %"
    assert quantity(5.32e-6, "%") == "5.32·10⁻⁶ %"
    assert quantity(2e-9, "m", rounding=1e-9) == "2·10⁻⁹ m"
    assert quantity(5e-7, "m", rounding=1e-6) == "0 (rounding)"
    assert number(0.0, rounding=1e-9) == "0"
    assert number(3.2e-18) == "3.20·10⁻¹⁸"


def test_degrees_stand_by_their_number():
    assert quantity(22.92, "°") == "22.9°"


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.2, "1 s"), (89.4, "89 s"), (90.0, "2 min"), (5399.0, "90 min"), (9000.0, "2.5 h")]
)
def test_durations_in_words(seconds, words):
    assert format_duration(seconds) == words
