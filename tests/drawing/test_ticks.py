import pytest

from runner.drawing.ticks import mark, minor_mark


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.1 + 0.2, "0.3"),
        (-1.25, "-1.25"),
        (3.975, "3.975"),
        (200.0, "200"),
        (0.005, "0.005"),
        (1e-4, "10⁻⁴"),
        (-1e-4, "-10⁻⁴"),
        (2.5e-5, "2.5·10⁻⁵"),
        (1e5, "10⁵"),
        (3e5, "3·10⁵"),
    ],
)
def test_marks_are_written_as_the_text_writes_numbers(value, text):
    assert mark(value) == text


def test_between_powers_of_ten_stand_2_and_5_alone():
    assert [minor_mark(step * 1e-5) for step in range(1, 10)] == ["", "2·10⁻⁵", "", "", "5·10⁻⁵", "", "", "", ""]
