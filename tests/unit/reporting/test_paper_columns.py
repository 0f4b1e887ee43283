"""Columns of tables for papers: digits by interval, one unit, powers of ten."""

import numpy as np
import pytest

from runner.reporting.export.columns import ScaledUnit, decimals, lay_out
from runner.reporting.export.paper_table import summarize
from runner.reporting.table import Column, Number, Table, numbers
from runner.statistics import median_interval


def column(unit, rows):
    samples = [summarize(row) for row in rows]
    return lay_out(Table("", [Column("error", "number", unit)], [[each.median] for each in samples]))[0], samples


@pytest.mark.parametrize(
    ("median", "low", "high", "expected"),
    [
        (4.853, 4.840, 4.870, 3),  # half width 0.015
        (61.4, 58.0, 64.0, 1),  # 3
        (4.9, 4.0, 26.0, 0),  # 11
        (12345.0, 11000.0, 14000.0, 0),
        (8.731, None, None, 2),
        (0.0735, None, None, 4),
        (1234.5, None, None, 0),
        (1.0, 1.0 - 1e-12, 1.0 + 1e-12, 5),  # six digits and no more
        (5.0, 4.0, np.inf, 1),
        (0.0, None, None, 0),
        (13.2, 0.187, np.inf, 1),  # 13.2 (0.2 to ∞), not 13 (0 to ∞)
        (13.2, -0.187, np.inf, 0),
        (13.2, 0.0, np.inf, 0),
        (13.2, 1e-4, np.inf, 4),
        (13.2, 1e-5, np.inf, 0),  # more than six digits
    ],
)
def test_an_interval_decides_about_the_digits(median, low, high, expected):
    assert decimals(median, low, high) == expected


def test_one_unit_serves_a_column():
    samples = np.array([[0.00485, 0.00487, 0.00483], [0.0614, 0.0620, 0.0612]])
    found, _ = column("m", samples)
    assert found.unit == ScaledUnit("mm")
    assert [cell.text for cell in found.cells] == ["4.85", "61.4"]


@pytest.mark.parametrize(("scale", "power", "median"), [(1e-7, -9, "500"), (2e6, 6, "10.0"), (1.0, 0, "5.00")])
def test_a_power_of_ten_stands_in_the_head(scale, power, median):
    found, _ = column("N^2 m^2 s", scale * np.array([[4.0, 5.0, 6.0]]))
    assert found.unit == ScaledUnit("N^2 m^2 s", power)
    assert found.cells[0].text == median


def test_the_interval_is_that_of_the_statistics():
    values = np.random.default_rng(5).normal(5.0, 0.1, size=20)
    (found, (sample,)), expected = column("N m", values[None, :]), median_interval(values)
    (cell,) = found.cells
    assert [float(text) for text in (cell.low, cell.text, cell.high)] == pytest.approx(
        [expected.low, expected.median, expected.high], abs=6e-4
    )
    assert sample.n == 20


def test_what_is_missing_is_told():
    inf, nan = np.inf, np.nan
    rows = np.array([[1.0, 2.0, inf, inf, inf, inf, inf], [nan] * 7, [3.0] * 7, [1e-15] * 6 + [2e-15]])
    found, samples = column("s", rows)
    lost, none, alike, rounding = found.cells
    assert (lost.text, lost.high, samples[0].lost) == ("∞", "∞", 5)
    assert (none.text, none.low, samples[1].n) == ("–", "", 0)
    assert (alike.low, alike.text) == ("", "3.00")
    assert (rounding.text, samples[3].median.is_rounding) == ("0", True)


def test_a_zero_has_no_sign():
    found, _ = column("1", np.array([[-0.004, -0.004, -0.004, 1.0, 1.0, 1.0, 1.0]]))
    assert found.cells[0].low == "0.00"


def test_numbers_of_rows_with_units_have_a_unit_and_power_each():
    rows = [["error", "m", Number(2e-3)], ["cost", "N^2 m^2 s", Number(5e6)], ["ratio", "1", Number(0.5)]]
    _, units, found = lay_out(Table("", ["metric", Column("unit", "unit"), *numbers("")], rows))
    assert [(cell.text, cell.unit) for cell in units.cells] == [
        ("mm", ScaledUnit("mm")),
        ("10⁶\u00a0N²\u00a0m²\u00a0s", ScaledUnit("N^2 m^2 s", 6)),
        ("", ScaledUnit("1")),
    ]
    assert [cell.text for cell in found.cells] == ["2.00", "5.00", "0.500"]
    assert found.head == "median"
