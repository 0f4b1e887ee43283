"""The audit as a report: counts, and one table of equations for each source with the runs of its wrong formulas."""

import math
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime

from runner import provenance
from runner.audit.audit import counts
from runner.audit.entry import Form
from runner.audit.inventory import inventory
from runner.audit.rollout import run_rollout
from runner.audit.verdict import SAMPLES, VERDICTS, Judged
from runner.expressions.parser import ExpressionError, parse
from runner.quantities import quantity
from runner.reporting.document import (
    Block,
    Curves,
    Document,
    Equation,
    EquationForm,
    Equations,
    Notice,
    Origin,
    Panel,
    Provenance,
    Section,
    Series,
    Table,
    Text,
)
from runner.reporting.markup import literals

COMMAND = "runner reproduce audit"


def audit_document(judged: Mapping[str, Sequence[Judged]]) -> Document:
    """Return the report on the audit.

    Args:
        judged: The verdicts of each source, by its name.
    """
    everything = [each for source in judged.values() for each in source]
    total = counts(everything)
    return Document(
        title="Equations of three published works, checked by machine",
        subtitle="Every printed equation against the arm's true kinematics and dynamics",
        abstract=(
            f"{len(everything)} equations were transcribed as they are printed and tried at {SAMPLES} random "
            f"configurations each. {total['correct']} are correct and {total['correct after repair']} more once damage "
            f"of the text is mended; {total['wrong as printed']} are wrong as printed, each with its right form below; "
            f"{total['unreadable']} can be read no more, and {total['definition']} only name things. Every verdict of "
            "wrong was found in two independent ways."
        ),
        sections=(
            Section("Counts", (_counts(judged), Text(_reading()), _inventory(judged))),
            *(_source(source, each) for source, each in judged.items()),
            Section("Provenance", (_provenance(),)),
        ),
        date=datetime.now(UTC).date().isoformat(),
    )


def _counts(judged: Mapping[str, Sequence[Judged]]) -> Table:
    rows = [[source, *map(str, counts(each).values()), str(len(each))] for source, each in judged.items()]
    total = counts([each for source in judged.values() for each in source])
    rows.append(["all", *map(str, total.values()), str(sum(total.values()))])
    return Table(
        "Equations of each source by verdict.",
        ["source", *VERDICTS, "all"],
        rows,
        tuple(range(1, len(VERDICTS) + 2)),
        Origin(command=COMMAND),
    )


def _reading() -> str:
    return (
        "A form is judged as it stands wherever it can be read, even where the text is more likely to be at fault "
        "than the author: we have the text of the three works as a machine read it, not their pages. It is repaired "
        "only where it cannot be read, or where a line is plainly damaged, and then the repair is stated and keeps "
        "every other sign; a wrong label, too, is judged as it stands unless those around it are plainly "
        "misread. Verdicts are worked out, not written down: the printed form, the repaired and the "
        "corrected one are evaluated at the same configurations and compared with the truth, once from Pinocchio's "
        "model or the like and once in a way that shares nothing with it but the arm's measures. The largest error is "
        "over all configurations and elements, the typical one the median over configurations of the largest "
        "element's."
    )


def _inventory(judged: Mapping[str, Sequence[Judged]]) -> Table:
    rows = []
    for source, each in judged.items():
        audited = [one.entry.place for one in each]
        for place in inventory(source).places:
            lost = ", ".join(place.lost) or "–"
            rows.append([source, place.place, str(len(place.equations)), str(audited.count(place.place)), lost])
    return Table(
        "Equations printed in each place of the text, and equations audited there; the last column names those that "
        "must have stood there and are missing from the text.",
        ["source", "place", "printed", "audited", "lost in the text"],
        [literals(line) for line in rows],
        (2, 3),
    )


def _source(source: str, judged: Sequence[Judged]) -> Section:
    ways = sorted({each.ways for each in judged if each.entry.truth})
    blocks: list[Block] = [
        Notice("finding", "What is wrong, and why", inventory(source).found),
        Equations(f"Equations of the {source} source.", [row(each) for each in judged], Origin(command=COMMAND)),
        Table("Ways to what the equations claim to equal.", ["one way", "another"], ways),
    ]
    names = dict.fromkeys(each.entry.rollout for each in judged if each.entry.rollout)
    runs = tuple(_run(source, name) for name in names)
    return Section(
        inventory(source).title,
        blocks,
        runs and (Section("What a robot does when it uses the wrong formulas", (), runs),),
    )


def row(judged: Judged) -> Equation:
    """Return the row of one equation in a table of them."""
    entry = judged.entry
    forms = [_form("as printed", entry.printed)]
    if entry.repair is not None:
        forms.append(_form("repaired", entry.repair, entry.repair.why))
    if entry.corrected is not None:
        forms.append(_form("corrected", entry.corrected))
    return Equation(entry.number, entry.title, entry.place, judged.verdict, _error(judged), forms, entry.finding)


def _error(judged: Judged) -> str:
    measured, entry = judged.measured, judged.entry
    if measured is None:
        return ""
    if judged.verdict != "wrong as printed":
        return f"within {quantity(entry.tolerance, entry.unit, 2)}"
    if math.isinf(measured.largest):
        return f"without bound, typically {quantity(measured.typical, entry.unit)}"
    return f"up to {quantity(measured.largest, entry.unit)}, typically {quantity(measured.typical, entry.unit)}"


def _form(label: str, form: Form, note: str = "") -> EquationForm:
    if form.math:
        return EquationForm(label, math=form.math, note=note)
    try:
        expressions = [(parse(name).root, parse(text).root) for name, text in form.elements.items()]
    except ExpressionError:
        raw = "; ".join(f"{name} = {text}" for name, text in form.elements.items())
        return EquationForm(f"{label}, as the text has it", raw=raw, note=note)
    return EquationForm(label, expressions=expressions, note=note)


def _run(source: str, name: str) -> Section:
    words, run = run_rollout(source, name)
    series = [Series(name, run.x, values) for name, values in run.curves.items()]
    panel = Panel("", words.x_label, words.y_label, series, y_log=words.logarithmic)
    caption = f"{words.title}: {words.y_label} over {words.x_label}."
    return Section(words.title, (Text(words.text), Curves(caption, [panel], columns=1, origin=Origin(command=COMMAND))))


def _provenance() -> Provenance:
    return Provenance(
        (
            ("commit", provenance.commit() or "none (installed package)"),
            ("configurations", f"{SAMPLES}, seed 0"),
            ("machine", provenance.machine()),
            *provenance.versions().items(),
        )
    )
