"""Strings for terminals and tables: control characters, length and formulas."""

import csv
import io

import pytest

from runner.base.sanitize import LINE, VALUE, escaped, lines, one_line, quoted, table_cell


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain, ä, °, 中", "plain, ä, °, 中"),
        ("\x1b]0;title\x07", r"\x1b]0;title\x07"),
        ("two\nlines\r\tand a tab", r"two\nlines\r\tand a tab"),
        ("\x9b2J\u202eback\udcff", r"\x9b2J\u202eback\udcff"),
        (r"\x1b as typed", r"\x1b as typed"),
    ],
)
def test_what_a_terminal_would_obey_is_shown_instead(text, shown):
    assert escaped(text) == one_line(text) == shown
    assert escaped(shown) == shown


def test_a_long_line_is_cut_and_says_how_long_it_was():
    shown = one_line("x" * 100_000)
    assert len(shown) == LINE
    assert shown.endswith("xxx... (100000 characters)")
    assert one_line("x" * LINE) == "x" * LINE
    assert len(one_line("\x1b" * LINE)) == LINE
    assert lines(f"a\n{'b' * 9999}\x1b\nc").count("\n") == 2


def test_of_many_lines_the_first_are_shown():
    assert lines("\n".join("x" * 50)) == "\n".join("x" * 50)
    shown = lines("\n".join("x" * 1000))
    assert shown.split("\n")[48:] == ["x", "and 951 more lines"]
    assert lines(shown) == shown


def test_values_are_quoted_to_a_line():
    assert quoted("a\nb") == r"'a\nb'"
    assert quoted([1, 2.5, None]) == "[1, 2.5, None]"
    assert len(quoted(["x"] * 100_000)) == VALUE
    assert quoted([10**5000]) == "a value too large to show (list)"


@pytest.mark.parametrize("text", ["-1", "+1e-3", "nan", "-inf", "quintic", "a=b", "", "a-b@c"])
def test_numbers_and_plain_words_stay_as_they_are_in_a_table(text):
    assert table_cell(text) == text


@pytest.mark.parametrize("text", ['=HYPERLINK("http://x")', "@SUM(1)", "+cmd|' /C calc'!A0", "-2+3", "\t=1", "\r=1"])
def test_no_cell_of_a_table_is_a_formula(text):
    stream = io.StringIO()
    csv.writer(stream).writerow([table_cell(text)])
    ((cell,),) = csv.reader(io.StringIO(stream.getvalue()))
    assert cell == f"'{escaped(text)}"
