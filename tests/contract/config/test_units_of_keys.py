"""Quantities, such as 20ms: read and put into the unit of a key, against the number in that unit."""

import math

import pytest

from runner.schema.units import explain_quantity, quantities_in, read_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("20ms", "s", 0.02),
        ("0.5s", "s", 0.5),
        ("2 min", "s", 120.0),
        ("5mm", "m", 0.005),
        ("-1.5 cm", "m", -0.015),
        ("3um", "m", 3e-6),
        ("3µm", "m", 3e-6),
        ("45deg", "rad", math.pi / 4),
        ("45°", "rad", math.pi / 4),
        ("-30deg", "rad", math.radians(-30)),
        ("1e-3rad", "rad", 1e-3),
        ("1E-3 rad", "rad", 1e-3),
        ("30rpm", "rad/s", math.pi),
        ("180deg/s", "rad/s", math.pi),
        ("10N", "N", 10.0),
        ("2.5kg", "kg", 2.5),
        ("250g", "kg", 0.25),
        ("3N m", "N m", 3.0),
        ("3Nm", "N m", 3.0),
        ("3 N*m", "N m", 3.0),
        ("3 N·m", "N m", 3.0),
        ("2 kg cm^2", "kg m^2", 2e-4),
        ("2kg cm²", "kg m^2", 2e-4),
        ("5N/mm", "N/m", 5000.0),
        ("1Nm/deg", "N m/rad", 180.0 / math.pi),
        ("4 1/s", "1/s", 4.0),
        ("1kHz", "Hz", 1000.0),
        ("1_000ms", "s", 1.0),
        (".5s", "s", 0.5),
        ("5.s", "s", 5.0),
    ],
)
def test_a_quantity_is_a_number_in_the_unit_of_its_key(text, unit, value):
    quantity = read_quantity(text)
    assert quantity is not None
    assert quantity.in_unit(unit) == value


def test_powers_of_ten_are_not_rounded():
    numbers = [*map(str, range(1, 1000, 7)), "0.1", "0.3", "1.1", "2.675", "33.3"]
    read = [read_quantity(f"{number}ms") for number in numbers]
    assert [quantity and quantity.in_unit("s") for quantity in read] == [float(f"{number}e-3") for number in numbers]


@pytest.mark.parametrize("value", ["0.01", "1e3", "1_000", "inf", "nan", "macro", "", "ms", "1+1", "5mm$", 5, 0.5, None,
                                   True, ["5mm"], "21/s", "1" * 100 + "mm"])  # fmt: skip
def test_what_is_no_quantity(value):
    assert read_quantity(value) is None


def test_a_quantity_of_another_unit_is_none_of_the_key():
    length = read_quantity("5mm")
    assert length is not None
    assert length.in_unit("s") is None
    unknown = read_quantity("5furlong")
    assert unknown is not None
    assert unknown.in_unit("m") is None
    hertz = read_quantity("5Hz")  # may be 5 or 10 pi rad/s
    assert hertz is not None
    assert hertz.in_unit("rad/s") is None


def test_an_exponent_beyond_all_floats_is_infinite():
    assert read_quantity("1e999s").in_unit("s") == math.inf
    assert read_quantity("1e9999s").in_unit("s") is None


@pytest.mark.parametrize(
    ("text", "units", "message"),
    [
        ("5mm", ("s",), "must be a number, or one with a unit of s (written s, ms, us, ns, min, h); found '5mm'"),
        ("5mm", (), "has no unit; found '5mm'; write only the number"),
        ("5msec", ("s",), "'msec' is not a unit (did you mean ms?)"),
        ("5kg", ("rad", "m"), "unit of rad (written rad, mrad, deg) or m (written m, cm, mm, um); found '5kg'"),
    ],
)
def test_what_does_not_fit_is_explained(text, units, message):
    assert message in explain_quantity(text, units)


def test_quantities_are_found_within_lists_and_mappings():
    assert list(quantities_in({"a": [1, "2mm", ["3deg"]], "b": {"c": "x"}, "d": "4s"})) == ["2mm", "3deg", "4s"]
