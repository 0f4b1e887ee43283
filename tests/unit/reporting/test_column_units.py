"""Units of table columns: one that spares powers of ten, digits kept."""

import pytest

from runner.base.quantities import number
from runner.reporting.consistency import in_readable_units, readable
from runner.reporting.document import Document, Section, Table


def column(head, *cells):
    table = readable(Table("", ["name", head], [["a", cell] for cell in cells]))
    return table.header[1], [row[1] for row in table.rows]


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
    ],
)
def test_a_column_of_lengths_has_one_unit_that_spares_powers_of_ten(values, unit, cells):
    assert column("error (m)", *map(number, values)) == (f"error ({unit})", cells)


def test_a_column_of_times_has_one_unit_and_other_quantities_keep_theirs():
    assert column("settles (s)", number(0.091)) == ("settles (ms)", ["91"])
    assert column("turn (rad)", number(9e-3)) == ("turn (rad)", ["9·10⁻³"])
    assert column("speed (m/s)", number(9e-3)) == ("speed (m/s)", ["9·10⁻³"])


def test_words_and_rounding_stay():
    assert column("error (m)", number(8e-3), number(1e-15, rounding=1e-12), "never", "failed") == (
        "error (mm)",
        ["8", "0 (rounding)", "never", "failed"],
    )


def test_digits_that_were_asked_for_stay():
    assert column("error (m)", number(8.12345e-3, 5)) == ("error (mm)", ["8.1235"])


@pytest.mark.parametrize("text", ["0.005", "5·10⁻³ at 2 s", "-0.2 to 0.2"])
def test_a_column_with_numbers_that_are_mere_text_is_left_alone(text):
    assert column("error (m)", number(8e-3), text) == ("error (m)", ["8·10⁻³", text])


def test_every_table_of_a_report_is_reached():
    table = Table("", ["error (m)"], [[number(8e-3)]])
    document = Document("", "", "", [Section("", (table,), [Section("", (table,))])], "")
    (chapter,) = in_readable_units(document).sections
    assert chapter.blocks[0].header == chapter.sections[0].blocks[0].header == ["error (mm)"]


def test_an_empty_table_stays():
    assert readable(Table("", ["error (m)"], [])).header == ["error (m)"]
