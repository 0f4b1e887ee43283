"""What counts as a change of a chapter."""

import numpy as np
import pytest
from support.recorded_texts import _agree, changes, lines, read, settle, write

from runner.reporting.document import Code, Notice, Section, Text


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


def test_each_value_is_a_line_without_those_that_are_empty_or_defaults():
    said = lines(Section("Lag", [Text("It lags."), Code("ls"), Notice("note", "Why", "So.", answer=True)]))
    assert said == [
        "Section",
        "  title: Lag",
        "  blocks:",
        "    - Text",
        "      text: It lags.",
        "    - Code",
        "      text: ls",
        "    - Notice",
        "      kind: note",
        "      title: Why",
        "      text: So.",
        "      answer: True",
    ]


@pytest.mark.parametrize("name", ["ab12cd34", "68569973", "0a" * 12, "1" * 24])
def test_a_name_of_content_is_left_out_and_a_number_is_not(name):
    assert lines({"text": f"Run {name}, runs/{name}. "})[0] == "text: Run ..., runs/...."
    kept = {"text": "At 0.12345678 s, of 1234567 and 123456789 ticks."}
    assert lines(kept) == [f"text: {kept['text']}"]


def test_a_row_is_a_line_and_so_is_each_sentence_of_a_long_string():
    first, second = "The first sentence is " + "very " * 20 + "long.", "The second is short; it goes on."
    assert lines({"rows": [["a", 1.0], ["b", None]], "text": f"{first} {second}"}) == [
        "rows:",
        "  - a | 1",
        "  - b | None",
        f"text: {first}",
        "  The second is short;",
        "  it goes on.",
    ]


def test_a_changed_sentence_is_told_with_its_line_and_rounding_is_not(tmp_path):
    was = ["text: One is 1.24.", "  Two is 3.5.", "  Three."]
    now = ["text: One is 1.25.", "  New.", "  Two is 3.5.", "  Four."]
    write(tmp_path / "reports" / "one.txt", was)
    assert read(tmp_path / "reports" / "one.txt") == was
    settled = settle(was, now)
    assert settled == ["text: One is 1.24.", "  New.", "  Two is 3.5.", "  Four."]
    assert changes("one.txt", was, settled).split("\n") == [
        "one.txt differs; if meant: make record",
        "--- one.txt as recorded",
        "+++ one.txt now",
        "@@ -1,3 +1,4 @@",
        " text: One is 1.24.",
        "+  New.",
        "   Two is 3.5.",
        "-  Three.",
        "+  Four.",
    ]
    assert settle(was, was) == was
    assert changes("one.txt", was, was) == ""


def test_a_large_difference_is_cut_and_a_file_that_is_not_recorded_is_empty(tmp_path):
    shown = changes("one.txt", read(tmp_path / "absent.txt"), [f"line {i}" for i in range(200)]).split("\n")
    assert len(shown) == 82
    assert shown[-1] == "... and 123 more lines"


def test_no_line_has_the_name_of_a_run():
    assert lines(["outputs/runs/0123456789abcdef01234567", "of 89abcdef"]) == ["outputs/runs/... | of ..."]


def test_a_drawing_has_a_line_for_each_text_and_for_each_path_that_is_not_a_letter():
    letter = '<defs><path d="M 9 9"/></defs><!-- rad -->'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg">{letter}<path style="fill: #fff" d="M 0 1 L 2.4 3"/></svg>'
    assert lines(svg) == ["rad", "fill: #fff 4 0 1 2 3"]


def test_numbers_of_the_size_of_rounding_are_recorded_as_zero_but_for_bounds():
    given = [1.3e-12, -2e-9, 1.2e-5, "off by 1.73·10⁻¹⁰ m, less than 1·10⁻¹² m", "error < 1·10⁻⁹", "0 (rounding)"]
    assert lines(given) == ["0 | 0 | 1.2e-05 | off by 0 m, 0 m | error < 1·10⁻⁹ | 0"]
    assert lines({"y": np.array([1e-17, 2.0])}) == ["y: (2,) 0 2"]


def test_digits_that_rounding_makes_are_left_out_of_all_that_a_caption_describes():
    section = Section("Inverse", [Text("It is 1.15 in 2 cases."), Text("The other 3.")])
    assert lines(section, [r"text: It is"])[4:7] == [
        "      text: It is # in # cases.",
        "    - Text",
        "      text: The other 3.",
    ]
    assert not any(character.isdigit() for line in lines(section, [r"title: Inverse"]) for character in line)
