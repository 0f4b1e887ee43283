"""What counts as a change of a chapter."""

import pytest
from support.recorded_texts import _agree, lines

from runner.reporting.document import Section, Text


@pytest.mark.parametrize(
    ("was", "now", "same"),
    [
        ("text: at most 1.24 mm", "text: at most 1.25 mm", True),
        ("text: at most 1.24 mm", "text: at most 1.27 mm", False),
        ("text: at most 1.24 mm", "text: at most 1.24 µm", False),
        ("text: 12 of 20 runs", "text: 11 of 20 runs", False),
        ("text: larger by 33.4 %", "text: larger by 33.7 %", False),
        ("text: less than 1.7·10⁻¹² N", "text: less than 3.9·10⁻¹³ N", True),
        ("text: less than 1.7·10⁻⁵ N", "text: less than 3.9·10⁻⁵ N", False),
        ("y: (3,) 0 1e-17 2", "y: (3,) 0 -3e-16 2", True),
        ("holds: True", "holds: False", False),
    ],
)
def test_lines_agree_in_words_and_but_for_rounding_in_numbers(was, now, same):
    assert _agree(was, now) is same


def test_each_value_is_a_line():
    said = lines(Section("Lag", [Text("It lags.")]))
    assert said[:5] == ["is: Section", "  title: Lag", "  blocks:", "    -: Text", "      text: It lags."]


def test_no_line_has_the_name_of_a_run():
    assert lines(["outputs/runs/0123456789abcdef01234567", "of 89abcdef"]) == [
        "is:",
        "  -: outputs/runs/...",
        "  -: of ...",
    ]


def test_a_drawing_has_a_line_for_each_text_and_for_each_path_that_is_no_letter():
    letter = '<defs><path d="M 9 9"/></defs><!-- rad -->'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg">{letter}<path style="fill: #fff" d="M 0 1 L 2.4 3"/></svg>'
    assert lines(svg) == ["is: rad", "is: fill: #fff 4 0 1 2 3"]


def test_numbers_of_the_size_of_rounding_are_kept_as_zero_but_for_bounds():
    assert lines(
        [1.3e-12, -2e-9, 1.2e-5, "off by 1.73·10⁻¹⁰ m, less than 1·10⁻¹² m", "error < 1·10⁻⁹", "0 (rounding)"]
    )[1:] == [
        "  -: 0",
        "  -: 0",
        "  -: 1.2e-05",
        "  -: off by 0 m, 0 m",
        "  -: error < 1·10⁻⁹",
        "  -: 0",
    ]


def test_digits_that_rounding_makes_are_left_out_of_all_that_a_caption_describes():
    section = Section("Inverse", [Text("It is 1.15 in 2 cases."), Text("The other 3.")])
    assert lines(section, [r"text: It is"])[4:7] == [
        "      text: It is # in # cases.",
        "    -: Text",
        "      text: The other 3.",
    ]
    assert not any(character.isdigit() for line in lines(section, [r"title: Inverse"]) for character in line)
