"""Data files are refused with file, entry and key."""

import pytest

from runner.base.data_file import line_of, read_data
from runner.base.errors import RunnerError
from runner.schema.model import StrictModel


class Entry(StrictModel):
    name: str = ""
    number: int = 0
    value: float


class File(StrictModel):
    title: str
    items: list[Entry]


def refused(tmp_path, text, model):
    path = tmp_path / "data.yaml"
    path.write_text(text)
    with pytest.raises(RunnerError) as error:
        read_data(path, model)
    assert str(path) in str(error.value)
    return str(error.value)


def test_a_file_or_a_list_of_entries_is_read(tmp_path):
    path = tmp_path / "data.yaml"
    path.write_text("title: A\nitems: [{name: mass, value: 1.0}]")
    assert read_data(path, File) == File(title="A", items=[Entry(name="mass", value=1.0)])
    path.write_text("- {number: 2, value: 1.0}")
    assert read_data(path, list[Entry]) == [Entry(number=2, value=1.0)]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("- {value: 1.0}\n- {name: mass}", ": 1 (mass).value: Field required"),
        ("- {number: 7, value: one}", ": 0 (7).value: Input should be a valid number"),
        ("- {value: 1.0, unit: kg}", ": 0.unit: unknown key; keys: name, number, value"),
        ("- mass", ": 0: Input should be"),
        ("mass: 1", "yaml: Input should be a valid list"),
        ("", "yaml: Input should be a valid list"),
    ],
)
def test_an_entry_is_named_by_its_place_and_its_name_or_number(tmp_path, text, told):
    assert told in refused(tmp_path, text, list[Entry])


def test_all_problems_are_told_at_once(tmp_path):
    message = refused(tmp_path, "items: [{name: mass}]", File)
    assert "title: Field required (line 1); items.0 (mass).value: Field required (line 1)" in message


def test_a_problem_has_its_line(tmp_path):
    text = "title: A\nitems:\n- name: a\n  value: 1\n- value: 2\n  nmae: kg\n- name: b\n"
    message = refused(tmp_path, text, File)
    assert "items.1.nmae: unknown key (did you mean name?); keys: name, number, value (line 6)" in message
    assert "items.2 (b).value: Field required (line 7)" in message


def test_what_cannot_be_read_is_refused(tmp_path):
    assert "cannot read" in refused(tmp_path, "title: [", File)
    with pytest.raises(RunnerError, match="cannot read"):
        read_data(tmp_path / "none.yaml", File)


def test_the_line_of_an_entry_is_found(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text("entries:\n- id: ab\n- id: a\n")
    assert (line_of(path, "id: a"), line_of(path, "id: ab")) == (3, 2)
