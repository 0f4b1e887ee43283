from runner.reporting.checklist import Checklist
from runner.reporting.document import Section

CHECKLIST = Checklist(
    title="Checklist",
    text="Its images are lost.",
    complete="All is here.",
    caption="Formulas.",
    place="chapter",
    items=(("Mass", "1", "checked", "Dynamics"), ("Sketch", "2", "drawn", "The arm")),
)
BELOW = Section("Arm", sections=(Section("Dynamics"),))


def test_items_are_found_by_title_at_any_depth():
    text, table = CHECKLIST.section([BELOW, Section("The arm")]).blocks
    assert text.text == "Its images are lost. All is here."
    assert table.header == ["what it is", "chapter", "state", "where"]
    assert table.rows == [["Mass", "1", "checked", "§1.1"], ["Sketch", "2", "drawn", "§2"]]


def test_what_is_missing_is_named():
    text, table = CHECKLIST.section([BELOW]).blocks
    assert text.text == "Its images are lost. Missing here: Sketch."
    assert table.rows[1] == ["Sketch", "2", "missing", "–"]
