"""Marks on axes: plain and logarithmic, in one notation."""

import pytest

from runner.reporting.charts.scales import at_2_and_5, marks, plain_mark, power_mark


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.1 + 0.2, "0.3"), (-1.25, "-1.25"), (3.975, "3.975"), (200.0, "200"), (0.0005, "0.0005"),
     (10000.0, "10000"), (-0.0, "0")],
)  # fmt: skip
def test_plain_marks(value, text):
    assert plain_mark(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1e-4, "10⁻⁴"), (-1e-4, "-10⁻⁴"), (2.5e-5, "2.5·10⁻⁵"), (1e5, "10⁵"), (3e5, "3·10⁵"), (1.0, "10⁰")],
)
def test_marks_with_powers(value, text):
    assert power_mark(value) == text


@pytest.mark.parametrize(
    ("low", "high", "log", "expected"),
    [
        (0.0, 0.0015, False, ["0.0005", "0.001"]),
        (0.0, 0.0009, False, ["5·10⁻⁴", "10⁻³"]),
        (-2.0, 1.0, False, ["0.0005", "0.001"]),
        (0.0, 5e4, False, ["5·10⁻⁴", "10⁻³"]),
        (1e-3, 1.0, True, ["0.0005", "0.001"]),
        (1e-4, 1.0, True, ["5·10⁻⁴", "10⁻³"]),
    ],
)
def test_an_axis_has_one_notation(low, high, log, expected):
    write = marks(low, high, log)
    assert [write(5e-4), write(1e-3)] == expected


def test_between_powers_of_ten_stand_2_and_5_alone():
    write = at_2_and_5(power_mark)
    assert [write(step * 1e-5) for step in range(1, 10)] == ["", "2·10⁻⁵", "", "", "5·10⁻⁵", "", "", "", ""]
