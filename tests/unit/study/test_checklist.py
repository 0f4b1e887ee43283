"""The checklist of a study, from its file to the section of its report."""

import pytest
from pydantic import ValidationError

from runner.base.paths import studies_with
from runner.papers.study.report import Checklist, load_checklist
from runner.reporting.document import Curves, Origin, Section

CONTENT = {
    "title": "Checklist",
    "text": "Its images are lost. {{ missing }}",
    "complete": "All is here.",
    "incomplete": "Missing here: {{ names }}.",
    "caption": "Formulas.",
    "columns": ["what it is", "chapter"],
    "items": [
        {"name": "Mass", "about": "1", "state": "checked", "section": "Dynamics"},
        {"name": "Sketch", "about": "2", "state": "drawn", "section": "The arm"},
    ],
}
NUMBERED = CONTENT | {
    "text": "{{ figures }} figures, {{ tables }} table, {{ here }} of {{ expected }}: {{ missing }}",
    "items": [
        {"name": "Figure 1.1", "about": "A bridge", "state": "of others", "absent": "a photograph"},
        {"name": "Figure 1.2", "about": "Torques", "state": "reproduced"},
        {"name": "Table 1.1", "about": "Masses", "state": "reproduced"},
    ],
}
BELOW = Section("Arm", sections=(Section("Dynamics"),))


def checklist(content=CONTENT):
    return Checklist.model_validate(content)


def figure(number):
    return Curves("A figure.", (), origin=Origin(number))


def test_items_are_found_by_title_at_any_depth():
    text, table = checklist().section([BELOW, Section("The arm")]).blocks
    assert text.text == "Its images are lost. All is here."
    assert table.lines[0] == ["what it is", "chapter", "state", "where"]
    assert table.lines[1:] == [["Mass", "1", "checked", "§1.1"], ["Sketch", "2", "drawn", "§2"]]


def test_what_is_missing_is_named():
    text, table = checklist().section([BELOW]).blocks
    assert text.text == "Its images are lost. Missing here: Sketch."
    assert table.lines[2] == ["Sketch", "2", "missing", "–"]


def test_items_without_a_section_are_found_by_their_number_where_it_stands_first():
    sections = [BELOW, Section("Motion", (figure("figure 1.2"),)), Section("Again", (figure("figure 1.2"),))]
    text, table = checklist(NUMBERED).section(sections).blocks
    assert text.text == "2 figures, 1 table, 1 of 2: Missing here: Table 1.1."
    assert table.lines[1:] == [
        ["Figure 1.1", "A bridge", "of others: a photograph", "–"],
        ["Figure 1.2", "Torques", "reproduced", "§2"],
        ["Table 1.1", "Masses", "missing", "–"],
    ]


def test_what_was_not_to_be_expected_and_is_there_is_drawn_anew():
    _, table = checklist(NUMBERED).section([Section("Motion", (figure("figure 1.1"),))]).blocks
    assert table.lines[1] == ["Figure 1.1", "A bridge", "drawn anew", "§1"]


@pytest.mark.parametrize("study", studies_with("checklist.yaml"))
def test_every_checklist_names_each_thing_once(study):
    names = [item.name for item in load_checklist(study).items]
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"items": []}, "items\n.* at least 1 item"),
        ({"columns": ["what it is"]}, "columns\n.* at least 2 items"),
        ({"text": "{{ missing }} and {{ more }}"}, "text: no name 'more' .*names: figures, tables, expected"),
        ({"incomplete": "not {{"}, "incomplete: {{ is not closed"),
        ({"incomplete": "{{ names.upper() }}"}, "incomplete: .* has no 'upper'"),
    ],
)
def test_a_checklist_that_cannot_be_shown_is_refused(changes, told):
    with pytest.raises(ValidationError, match=told):
        checklist(CONTENT | changes)
