"""Tables in text files in every layout, against arrays by hand."""

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.base.tables import read_text_table

T, Q = np.arange(60) / 100.0, np.sin(np.arange(60) / 10.0)


def read(tmp_path, text, wanted=None):
    path = tmp_path / "log.txt"
    path.write_text(text, encoding="utf-8")
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        return read_text_table(path, file, wanted)


def lines(separator, point="."):
    return [f"{t:.4f}{separator}{q:.17g}".replace(".", point) for t, q in zip(T, Q, strict=True)]


@pytest.mark.parametrize(
    ("head", "separator", "point", "form"),
    [
        (["t,q"], ",", ".", "commas"),
        (["t;q"], ";", ",", "semicolons"),
        (["t\tq"], "\t", ",", "tabs"),
        (["t q"], " ", ".", "blanks"),
        (["  t    q"], "   ", ".", "blanks"),
        (["# made by hand", "#", "t,q"], ",", ".", "commas"),
        (["% t q"], " ", ".", "blanks"),
        (["# t,q"], ",", ".", "commas"),
        (["", "t,q"], ",", ".", "commas"),
        (["\ufefft,q"], ",", ".", "commas"),
        (['"t", "q"'], ",", ".", "commas"),
    ],
)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_every_layout(tmp_path, head, separator, point, form, end):
    found = read(tmp_path, end.join([*head, *lines(separator, point), ""]))
    names = [name.strip(' "') for name in found.columns]
    assert names == ["t", "q"]
    assert next(iter(found.columns.values())) == pytest.approx(T)
    assert [*found.columns.values()][1] == pytest.approx(Q, rel=1e-15)
    assert found.form.endswith(f"separated by {form}")
    assert found.place(0) == f"line {len(head) + 1}"


def test_a_file_without_names_has_numbered_columns(tmp_path):
    assert list(read(tmp_path, "\n".join(lines(" "))).columns) == ["column 1", "column 2"]


@pytest.mark.parametrize("units", ["s,rad", "[s],[rad]"])
def test_a_line_of_units(tmp_path, units):
    found = read(tmp_path, "\n".join(["t,q", units, *lines(","), ""]), ["t", "q"])
    assert found.units == {"t": "s", "q": "rad"}
    assert len(found) == 60
    assert found.place(0) == "line 3"


def test_columns_of_text_are_named_and_not_read(tmp_path):
    found = read(tmp_path, "\n".join(["t,mode,q", *(line.replace(",", ",run,") for line in lines(","))]))
    assert list(found.columns) == ["t", "q"]
    assert found.others == {"mode": "run"}


def test_rows_of_other_series_are_left_out(tmp_path):
    rows = [text for line in lines(",") for text in (f"{line},", f"{line.split(',')[0]}1,,5.0")]
    found = read(tmp_path, "\n".join(["t,q,other", *rows, ""]), ["t", "q"]).of(["t", "q"], "t")
    assert found.columns["q"] == pytest.approx(Q)
    assert found.notes == ("60 rows without any of the columns are left out",)


def test_trailing_separators_and_a_line_that_is_cut_off(tmp_path):
    found = read(tmp_path, "\n".join(["t,q,", *(f"{line}," for line in lines(",")), "0.6"]), ["t", "q"])
    assert len(found) == 60
    assert found.notes == ("the last line, 62, is cut off and left out",)
    with pytest.raises(RunnerError, match="line 62: 1 cells for 2 columns"):
        read(tmp_path, "\n".join(["t,q", *lines(","), "0.6", ""]), ["t", "q"])


def test_an_empty_file_is_named(tmp_path):
    for text in ("", "\n\n", "# nothing\n"):
        with pytest.raises(RunnerError, match=r"is empty\. Allowed: rows of numbers"):
            read(tmp_path, text)
