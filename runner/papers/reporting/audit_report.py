"""Audit report: the equations of each source, wrong ones first, and their effect on a robot."""

import math
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime

from runner.assembly.versions import versions
from runner.base import progress
from runner.base.data_file import line_of
from runner.base.machine import this_machine
from runner.base.quantities import quantity
from runner.papers.audit.audit import counts, inventory
from runner.papers.audit.consequence import simulate_consequence
from runner.papers.audit.entry import entries
from runner.papers.audit.sources import Where
from runner.papers.audit.verdict import SAMPLES, VERDICTS, CheckedEquation
from runner.papers.reporting.audit_forms import RightElements, forms_of
from runner.papers.reporting.equation import Equation, Equations
from runner.reporting.document import (
    Curves,
    Document,
    Items,
    Notice,
    Origin,
    Panel,
    Provenance,
    ReportBlock,
    Section,
    Series,
    Table,
    Text,
)
from runner.reporting.markup import mark_text
from runner.reporting.mathml import faulty
from runner.reporting.metric_titles import capital
from runner.reporting.table import numbers
from runner.reporting.verdicts import WORDS
from runner.simulation import provenance

COMMAND = "runner reproduce audit"
DATA = "equations.csv"
"""Name of the table of all equations, a file next to the report."""

_PANELS = 4  # panels of a figure
_WORDS = " ".join(f"{capital(verdict)}: {WORDS[verdict].meaning}." for verdict in VERDICTS)


def audit_document(checked: Mapping[str, Sequence[CheckedEquation]]) -> Document:
    """Return the report on the audit.

    Args:
        checked: The verdicts of each source, by its name.
    """
    everything = [each for source in checked.values() for each in source]
    total = counts(everything)
    progress.begin("trying", sum(len(_consequences(each)) for each in checked.values()), "wrong formulas")
    return Document(
        title="Equations of three published sources, checked by machine",
        subtitle="Every printed equation against the arm's true kinematics and dynamics",
        abstract=(
            f"{len(everything)} equations were transcribed as they are printed and tried at {SAMPLES} random "
            f"configurations each. {total['correct']} are correct and {total['correct after emendation']} more once "
            f"damage of the text is emended; {total['wrong as printed']} are wrong as printed, each with its right "
            f"form below; {total['unreadable']} can be read no more, and {total['definition']} only name things. Every "
            "verdict of wrong was found by two independent derivations."
        ),
        sections=(
            *(_source(source, each) for source, each in checked.items()),
            Section(
                "How they were checked",
                (Text(_reading()), _counts(checked), _derivations(checked), _inventory(checked)),
            ),
            Section("Provenance", (_provenance(),)),
        ),
        notes=(_WORDS, f"Each square leads to its equations. All of them, whole, stand in {DATA} next to this report."),
        date=datetime.now(UTC).date().isoformat(),
    )


def _counts(checked: Mapping[str, Sequence[CheckedEquation]]) -> Table:
    rows = [[source, *map(str, counts(each).values()), str(len(each))] for source, each in checked.items()]
    total = counts([each for source in checked.values() for each in source])
    rows.append(["all", *map(str, total.values()), str(sum(total.values()))])
    return Table(
        "Equations of each source by verdict.",
        ["source", *numbers(*VERDICTS, "all")],
        rows,
        Origin(command=COMMAND),
    )


def _reading() -> str:
    return (
        "A form is checked as printed wherever it can be read, even where the text is more likely to be at fault "
        "than the author: we have the text of the three sources as a machine read it, not their pages. It is emended "
        "only where it cannot be read, or where a line is plainly damaged, and then the emendation is stated and keeps "
        "every other sign; a wrong label, too, is checked as printed unless those around it are plainly "
        "misread. Verdicts are computed, not written down: the printed form, the emended and the "
        "corrected one are evaluated at the same configurations and compared with two independent derivations, one "
        "from Pinocchio's model or the like and one that shares only the arm's dimensions with it. The largest error "
        "is over all configurations and elements, the typical one the median over configurations of the largest "
        "element's."
    )


def _inventory(checked: Mapping[str, Sequence[CheckedEquation]]) -> Table:
    rows = []
    for source, each in checked.items():
        audited = [one.entry.place for one in each]
        for place in inventory(source).places:
            lost = ", ".join(place.lost) or "–"
            rows.append([source, place.place, str(len(place.equations)), str(audited.count(place.place)), lost])
    return Table(
        "Equations printed in each place of the text, and equations audited there; the last column names those that "
        "must have stood there and are missing from the text.",
        ["source", "place", *numbers("printed", "audited"), "lost in the text"],
        rows,
    )


def _derivations(checked: Mapping[str, Sequence[CheckedEquation]]) -> Table:
    found: dict[tuple[str, str], dict[str, None]] = {}
    for source, each in checked.items():
        for one, another in sorted({one.methods for one in each if one.entry.derivation}):
            found.setdefault((source, one), {})[another] = None
    lines = [[source, one, "; ".join(others)] for (source, one), others in found.items()]
    return Table(
        "Reference derivations of what the equations claim to equal.",
        ["source", "first derivation", "second derivation"],
        lines,
    )


def _source(source: str, checked: Sequence[CheckedEquation]) -> Section:
    blocks: list[ReportBlock] = [
        Notice("finding", "What is wrong, and why", inventory(source).found),
        Equations(f"Equations of the {source} source.", rows(checked), source=source, data=DATA),
    ]
    names = _consequences(checked)
    return Section(inventory(source).title, blocks, (_runs(source, names),) if names else ())


def _consequences(checked: Sequence[CheckedEquation]) -> Sequence[str]:
    return list(dict.fromkeys(each.entry.consequence for each in checked if each.entry.consequence))


def rows(checked: Sequence[CheckedEquation]) -> list[Equation]:
    """Return the equations of a source for a report, in the order of the text."""
    right = RightElements(checked)
    return [
        Equation(
            each.entry.number,
            each.entry.title,
            each.entry.place,
            each.verdict,
            _error(each),
            forms_of(each.entry, right, each.letters),
            each.entry.finding,
        )
        for each in checked
    ]


def faulty_formulas(where: Where, checked: Sequence[CheckedEquation]) -> list[str]:
    """Return a line with file, line and id for each formula of checked equations that Typst rejects."""
    paths = {entry.id: part.path for part, entry in entries(where)}
    shown = {each.entry.id: row for each, row in zip(checked, rows(checked), strict=True)}
    faulty(_only(shown.values()))  # all at once: those of each are known then
    return [
        f"{paths[name]}, line {line_of(paths[name], f'id: {name}')}: {name}: no formula in Typst's notation: {formula}"
        for name, row in shown.items()
        for formula in faulty(_only([row]))
    ]


def _only(shown: Iterable[Equation]) -> Document:
    return Document("", "", "", (Section("", (Equations("", list(shown)),)),), "")


def _error(checked: CheckedEquation) -> str:
    measured, entry = checked.measured, checked.entry
    if measured is None:
        return ""
    if checked.verdict != "wrong as printed":
        return f"within {quantity(entry.tolerance, entry.unit, 2)}"
    if math.isinf(measured.largest):
        return "without bound"
    return f"up to {quantity(measured.largest, entry.unit)}, typically {quantity(measured.typical, entry.unit)}"


def _runs(source: str, names: Iterable[str]) -> Section:
    """Return the motion of a robot that uses the wrong formulas: a sentence and a panel for each run."""
    found = []
    for name in names:
        found.append(simulate_consequence(source, name))
        progress.step()
    told = [f"{mark_text(words.title, 'emphasis')}: {words.text}" for words, _ in found]
    panels = [
        Panel(
            words.title,
            words.x_label,
            words.y_label,
            [Series(name, run.x, values) for name, values in run.curves.items()],
            y_log=words.logarithmic,
        )
        for words, run in found
    ]
    caption = f"What becomes of a robot that uses a wrong formula of {source}, next to one that uses the corrected one."
    figures = [Curves(caption, panels[first : first + _PANELS]) for first in range(0, len(panels), _PANELS)]
    return Section("What a robot does when it uses the wrong formulas", (Items(told), *figures))


def _provenance() -> Provenance:
    return Provenance(
        (
            ("commit", provenance.commit() or "none (installed package)"),
            ("configurations", f"{SAMPLES}, seed 0"),
            ("machine", this_machine().text),
            *versions().items(),
        )
    )
