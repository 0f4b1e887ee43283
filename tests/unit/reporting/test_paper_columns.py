"""Columns of tables for papers: digits by interval, one unit, powers of ten."""

import numpy as np
import pytest

from runner.reporting.export.columns import column, decimals
from runner.statistics import median_interval


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
    ],
)
def test_an_interval_decides_about_the_digits(median, low, high, expected):
    assert decimals(median, low, high) == expected


def test_one_unit_serves_a_column():
    samples = np.array([[0.00485, 0.00487, 0.00483], [0.0614, 0.0620, 0.0612]])
    found = column("error", "m", samples)
    assert (found.unit, found.unit.power) == ("mm", 0)
    assert [cell.median for cell in found.cells] == ["4.85", "61.4"]


@pytest.mark.parametrize(("scale", "power", "median"), [(1e-7, -9, "500"), (2e6, 6, "10.0"), (1.0, 0, "5.00")])
def test_a_power_of_ten_stands_in_the_head(scale, power, median):
    found = column("cost", "N^2 m^2 s", scale * np.array([[4.0, 5.0, 6.0]]))
    assert (found.unit, found.unit.power) == ("N^2 m^2 s", power)
    assert found.cells[0].median == median


def test_the_interval_is_that_of_the_statistics():
    values = np.random.default_rng(5).normal(5.0, 0.1, size=20)
    cell, expected = column("torque", "N m", values[None, :]).cells[0], median_interval(values)
    assert [float(text) for text in (cell.low, cell.median, cell.high)] == pytest.approx(
        [expected.low, expected.median, expected.high], abs=6e-4
    )
    assert cell.n == 20


def test_what_is_missing_is_told():
    inf, nan = np.inf, np.nan
    rows = np.array([[1.0, 2.0, inf, inf, inf, inf, inf], [nan] * 7, [3.0] * 7, [1e-15] * 6 + [2e-15]])
    lost, none, alike, rounding = column("settling time", "s", rows).cells
    assert (lost.median, lost.high, lost.lost) == ("∞", "∞", 5)
    assert (none.median, none.low, none.n) == ("–", "", 0)
    assert (alike.low, alike.alike, alike.median) == ("", True, "3.00")
    assert (rounding.median, rounding.rounding) == ("0", True)


def test_a_zero_has_no_sign():
    assert column("error", "1", np.array([[-0.004, -0.004, -0.004, 1.0, 1.0, 1.0, 1.0]])).cells[0].low == "0.00"
