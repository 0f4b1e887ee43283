"""Every figure and formula of the xArm7 report, and where it stands in ours."""

from collections.abc import Sequence

from runner.reporting import outline
from runner.reporting.document import Document, Section, Table, Text

_REPRODUCED, _CHECKED, _WORKING = "reproduced", "checked in numbers", "not in the report, as its code did not work"
# What it is, the report's section, what we did with it, and the title of our section.
_LIST: tuple[tuple[str, str, str, str], ...] = (
    ("Sketch of the motion", "Description of the task", _REPRODUCED, "The line by three joints"),
    ("Transforms, A07 and P_e", "Position control with three joints", _CHECKED, "The tip's position"),
    ("Formulas of q1, q2 and q4", "Inverse kinematic control", _CHECKED, "Inverse kinematics"),
    ("Further solutions of q2 and q4", "Inverse kinematic control", _CHECKED, "The four ways to reach a point"),
    ("Jacobian, J11 to J67", "Jacobian matrix", _CHECKED, "Why the second part failed"),
    ("Trajectory planning", "Trajectory planning", _REPRODUCED, "The line by three joints"),
    ("Graphs of x, y and z", "Position control with three joints", _REPRODUCED, "The line by three joints"),
    ("Graphs of q1, q2 and q4", "Position control with three joints", _REPRODUCED, "The line by three joints"),
    ("Pseudo-inverse", "Position control with seven joints", _CHECKED, "Why the second part failed"),
    ("Graphs with seven joints", "Position control with seven joints", _WORKING, "The line by seven joints"),
)


def checklist_section(sections: Sequence[Section]) -> Section:
    """Return the checklist, its places found by title in the report itself.

    Args:
        sections: All chapters of the report from its first on, those that follow the checklist may be left out.
    """
    chapters = outline.chapters(Document("", "", "", sections, ""))
    places = {chapter.section.title: f"§{chapter.number}" for chapter in chapters}
    rows = [[what, where, state if title in places else "missing", places.get(title, "–")]
            for what, where, state, title in _LIST]  # fmt: skip
    missing = [what for what, _, _, title in _LIST if title not in places]
    return Section(
        "Checklist: every figure and formula of the report",
        (
            Text(
                "The report does not number its figures, and their images are lost in the text that has come down "
                "to us: the curves can be made again, not laid over the printed ones. "
                + (f"Missing here: {', '.join(missing)}." if missing else "None is missing here.")
            ),
            Table(
                "Figures and formulas of the report.", ["what it is", "section of the report", "state", "where"], rows
            ),
        ),
    )
