"""Every figure and table of the thesis, and where it stands in the report."""

from collections.abc import Sequence

from runner.reporting import outline
from runner.reporting.document import Claim, Formula, Items, Notice, Provenance, Section, Table, Text

_SIMULATED, _DRAWN, _FOREIGN, _LOST = "reproduced", "drawn anew", "of others", "lost"
_PHOTOGRAPH = "a photograph from the literature"
# Number, title, state, and the reason where it is not to be expected in the report.
_LIST: tuple[tuple[str, str, str, str], ...] = (
    ("figure 1.1", "Inspection of underground tanks", _FOREIGN, _PHOTOGRAPH),
    ("figure 1.2", "Inspection of bridges", _FOREIGN, _PHOTOGRAPH),
    ("figure 1.3", "Macro-Micro manipulator with optical sensor", _FOREIGN, _PHOTOGRAPH),
    (
        "figure 2.1",
        "Overview of the system, and the human arm",
        _FOREIGN,
        "an illustration; the arm itself is figure 5.1",
    ),
    (
        "figure 2.2",
        "Model of a one-axis Macro-Micro manipulator",
        _FOREIGN,
        "another author's arm, from the literature",
    ),
    ("figure 2.3", "Workspace of the Macro", _DRAWN, ""),
    ("figure 2.4", "Workspace of the Mini", _DRAWN, ""),
    ("table 2.1", "Parameters of Macro and Mini", _SIMULATED, ""),
    ("figure 3.1", "Frames of the Macro at home", _DRAWN, ""),
    ("figure 3.2", "Denavit-Hartenberg frame assignment", _FOREIGN, "a textbook's figure"),
    ("table 3.1", "D-H parameters of the Macro", _SIMULATED, ""),
    ("figure 3.3", "Position of the centre of mass", _LOST, "a sketch of one link; the masses are in table 2.1"),
    ("figure 3.4", "Goal position control of the Macro, block diagram", _DRAWN, ""),
    ("figure 3.5", "Macro, goal position: torques and tip error", _SIMULATED, ""),
    ("figure 3.6", "A quintic in x direction", _SIMULATED, ""),
    ("figure 3.7", "Tracking control of the Macro, block diagram", _DRAWN, ""),
    ("figure 3.8", "Desired motion of the Macro", _SIMULATED, ""),
    ("figure 3.9", "Macro, tracking with torque limit", _SIMULATED, ""),
    ("figure 3.10", "Macro, tracking without torque limit", _SIMULATED, ""),
    ("figure 4.1", "Frames of the Mini at home", _DRAWN, ""),
    ("table 4.1", "D-H parameters of the Mini", _SIMULATED, ""),
    ("figure 4.2", "Mini, goal position: torques and tip error", _SIMULATED, ""),
    ("figure 4.3", "Desired motion of the Mini", _SIMULATED, ""),
    ("figure 4.4", "Mini, tracking", _SIMULATED, ""),
    ("figure 5.1", "Frames of the Macro-Mini", _DRAWN, ""),
    ("table 5.1", "D-H parameters of the Macro-Mini", "lost in the text, derived again", ""),
    ("figure 5.2", "Method 1: one overall strategy, block diagram", _DRAWN, ""),
    ("figure 5.3", "Method 2: trajectories of Macro and Mini in x", _SIMULATED, ""),
    ("figure 5.4", "Method 2: separate controllers, block diagram", _DRAWN, ""),
    ("figure 5.5", "Method 3: overall strategy on top, block diagram", _DRAWN, ""),
    ("figure 5.6", "Control steps", _DRAWN, ""),
    ("figure 5.7", "One-way coupling, block diagram", _DRAWN, ""),
    ("figure 5.8", "Macro-Mini, goal position, one-way coupling", _SIMULATED, ""),
    ("figure 5.9", "Two-way coupling, block diagram", _DRAWN, ""),
    ("figure 5.10", "Macro-Mini, goal position, two-way coupling", _SIMULATED, ""),
    ("figure 5.11", "Desired motion of the Macro-Mini's tip", _SIMULATED, ""),
    ("figure 5.12", "Macro-Mini, tracking, one-way coupling", _SIMULATED, ""),
    ("figure 5.13", "Macro-Mini, tracking, two-way coupling", _SIMULATED, ""),
)


def checklist_section(sections: Sequence[Section]) -> Section:
    """Return the checklist, its places found in the report itself.

    Args:
        sections: All chapters of the report from its first on, those that follow the checklist may be left out.
    """
    places = _places(sections)
    rows, missing = [], []
    for number, title, state, reason in _LIST:
        label = number.capitalize()
        if number in places:
            rows.append([label, title, _DRAWN if reason else state, places[number]])
        elif reason:
            rows.append([label, title, f"{state}: {reason}", "–"])
        else:
            missing.append(label)
            rows.append([label, title, "missing", "–"])
    ours = sum(not reason for *_, reason in _LIST)
    text = (
        f"The thesis has {sum(n.startswith('figure') for n, *_ in _LIST)} figures and "
        f"{sum(n.startswith('table') for n, *_ in _LIST)} tables. {ours - len(missing)} of the {ours} that can be "
        "remade stand in this report, "
        + (f"all but {', '.join(missing)}. " if missing else "none is missing. ")
        + "Reproduced: made again from simulation or model, with the quantities that the thesis' captions name. "
        "Drawn anew: made from the model or from the graph of the controller that ran. The images of the thesis are "
        "lost in the text that has come down to us; only captions and the numbers in its text can be compared."
    )
    table = Table("All figures and tables of the thesis.", ["number", "what it shows", "state", "where"], rows)
    return Section("Checklist: every figure and table of the thesis", (Text(text), table))


def _places(sections: Sequence[Section]) -> dict[str, str]:
    """Return the section in which each number of the thesis stands first."""
    places: dict[str, str] = {}
    for chapter in outline.numbered(sections):
        for block in chapter.section.blocks:
            if not isinstance(block, Text | Items | Notice | Formula | Claim | Provenance) and block.origin.number:
                places.setdefault(block.origin.number.lower(), f"§{chapter.number}")
    return places
