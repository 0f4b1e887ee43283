"""Tables: units of columns that spare powers of ten, digits, dollar signs, and lines for a terminal."""

import pytest

from runner.reporting.table import Column, Number, Table, numbers, terminal


def column(title, unit, *cells):
    head, *texts = Table("", ["name", Column(title, "number", unit)], [["a", cell] for cell in cells]).lines
    return head[1], [row[1] for row in texts]


@pytest.mark.parametrize(
    ("values", "unit", "cells"),
    [
        ((8.73e-3, 3.9e-4), "mm", ["8.73", "0.39"]),
        ((0.05, 0.02), "mm", ["50", "20"]),
        ((2.5e-7, 4e-6), "µm", ["0.25", "4"]),
        ((0.0105, 2.62e-5, 1.64e-7), "mm", ["10.5", "0.0262", "0.000164"]),
        ((1.33, 3.83e-6), "mm", ["1330", "0.00383"]),
        ((0.5, 0.25), "m", ["0.5", "0.25"]),
        ((0.5, 0.0), "m", ["0.5", "0"]),
        ((0.947, 3.9e-4), "mm", ["947", "0.39"]),
        ((0.5, None), "m", ["0.5", "–"]),
        ((8e-3, None), "mm", ["8", "–"]),
        ((2e-9, 3e-9), "µm", ["0.002", "0.003"]),
        ((2e-12, 3e-12), "m", ["2·10⁻¹²", "3·10⁻¹²"]),
        ((2e-13, 0.0), "m", ["0 (rounding)", "0"]),
        ((float("inf"), 8e-3), "mm", ["∞", "8"]),
    ],
)
def test_a_column_of_lengths_has_one_unit_that_spares_powers_of_ten(values, unit, cells):
    assert column("error", "m", *map(Number, values)) == (f"error ({unit})", cells)


def test_a_column_of_times_has_one_unit_and_other_quantities_keep_theirs():
    assert column("settles", "s", Number(0.091)) == ("settles (ms)", ["91"])
    assert column("turn", "rad", Number(9e-3)) == ("turn (rad)", ["9·10⁻³"])
    assert column("speed", "m/s", Number(9e-3)) == ("speed (m/s)", ["9·10⁻³"])


def test_words_and_rounding_stay():
    assert column("error", "m", Number(8e-3), Number(1e-15), "never", "failed") == (
        "error (mm)",
        ["8", "0 (rounding)", "never", "failed"],
    )


def test_digits_that_were_asked_for_stay():
    assert column("error", "m", Number(8.12345e-3, digits=5)) == ("error (mm)", ["8.1235"])


@pytest.mark.parametrize("text", ["0.005", "5·10⁻³ at 2 s", "-0.2 to 0.2"])
def test_a_column_with_numbers_that_are_mere_text_is_left_alone(text):
    assert column("error", "m", Number(8e-3), text) == ("error (m)", ["8·10⁻³", text])


def test_a_number_without_unit_has_none():
    assert column("ratio", "1", Number(0.5)) == ("ratio", ["0.5"])


def test_an_interval_has_the_unit_of_its_column():
    assert column("error", "m", Number(2e-3, 1e-3, 3e-3), Number(None, 1e-3, 3e-3))[1] == ["2 (1 to 3)", "1 to 3"]


def test_an_empty_table_stays():
    assert Table("", [Column("error", "number", "m")], []).lines == [["error (m)"]]


def test_dollar_signs_are_literal_unless_a_table_is_prose():
    cells = ["$a$", *numbers("$b$")], [["$c$", "$"]]
    assert Table("", *cells).lines == [["$$a$$", "$$b$$"], ["$$c$$", "$$"]]
    assert Table("", *cells, prose=True).lines == [["$a$", "$b$"], ["$c$", "$"]]


def test_a_terminal_has_aligned_columns_in_si_units():
    table = Table("", ["a", Column("error", "number", "m")], [["longer", Number(8.1234567e-3)], ["", Number(None)]])
    assert terminal(table) == "  a       error (m)\n  longer  0.0081235\n          -"


def test_a_table_without_titles_has_no_line_for_them():
    assert terminal(Table("", ["", ""], [["a", "long"], ["longer", "b"]]), "") == "a       long\nlonger  b"


def test_no_cell_speaks_to_the_terminal():
    rows = [["robot.name", "\x1b]0;title\x07", "two\nlines"]]
    assert terminal(Table("", [""] * 3, rows)) == r"  robot.name  \x1b]0;title\x07  two\nlines"
