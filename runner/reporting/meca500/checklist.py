"""Every table, figure and formula of the Meca500 report, and where it stands in ours."""

from collections.abc import Sequence

from runner.reporting import outline
from runner.reporting.document import Document, Section, Table, Text

_CHECKED, _DONE = "checked in numbers", "carried out against known truth"
# What it is, the report's section, what we did with it, and the title of our section.
_LIST: tuple[tuple[str, str, str, str], ...] = (
    ("Table 1, D-H parameters", "1", _CHECKED, "Kinematics, element by element"),
    ("Jacobian in frame 6, continued", "1", _CHECKED, "Kinematics, element by element"),
    ("Equations (1) to (5), four-point method", "2", _DONE, "Tool centre point"),
    ("Equation (6), direction of the tool", "3", _DONE, "Tool direction and alignment"),
    ("Equation (7) and Figure 1, alignment", "3", _DONE, "Tool direction and alignment"),
    ("Equations of gravity compensation", "4", _DONE, "Gravity compensation"),
    ("Equation (8), admittance", "5", _CHECKED, "Step response of each axis"),
    ("Equation (8) in the Laplace variable", "5", _CHECKED, "Frequency response"),
    ("Rotations and their Jacobians", "5", _CHECKED, "Step response of each axis"),
    ("Change of the reference frame", "6", _CHECKED, "Work at the tool tip"),
    ("Forward kinematics", "7.1", _CHECKED, "Kinematics, element by element"),
    ("Jacobian matrices", "7.2", _CHECKED, "Kinematics, element by element"),
)


def checklist_section(sections: Sequence[Section]) -> Section:
    """Return the checklist, its places found by title in the report itself.

    Args:
        sections: All chapters of the report from its first on, those that follow the checklist may be left out.
    """
    chapters = outline.chapters(Document("", "", "", sections, ""))
    places = {chapter.section.title: f"§{chapter.number}" for chapter in chapters}
    rows = [
        [what, section, state if title in places else "missing", places.get(title, "–")]
        for what, section, state, title in _LIST
    ]
    missing = [what for what, _, _, title in _LIST if title not in places]
    return Section(
        "Checklist: every table and formula of the report",
        (
            Text(
                "The report's photographs and sketches are lost in the text that has come down to us. "
                + (f"Missing here: {', '.join(missing)}." if missing else "Nothing else is missing here.")
            ),
            Table("Tables and formulas of the report.", ["what it is", "section", "state", "where"], rows),
        ),
    )
