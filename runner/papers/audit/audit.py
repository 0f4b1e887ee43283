"""Verdicts on every equation of a source, their table as CSV, and the inventory of the source."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from pydantic import Field

from runner.base import progress
from runner.base.data_file import read_data
from runner.base.sanitize import csv_text
from runner.papers.audit.entry import Form, SourceFile, entries, parts
from runner.papers.audit.sources import Where, source_of, sources
from runner.papers.audit.verdict import SAMPLES, VERDICTS, AuditError, Check, CheckedEquation, Verdict
from runner.schema.model import StrictModel


def audit(where: Where, samples: int = SAMPLES) -> list[CheckedEquation]:
    """Return the verdict on every equation of a source, in the order of the text.

    Args:
        where: Name of a built-in study, or a folder, as in audit(Path("my_paper")); see `sources.py`.
        samples: How many configurations each is tried at.

    Raises:
        RunnerError: If there is no such source, a file does not fit its format, or what it names does not exist.
        AuditError: If entries contradict themselves; names all of them.
    """
    return list(_checked(parts(where), samples))


def audit_all(samples: int = SAMPLES) -> dict[str, list[CheckedEquation]]:
    """Return the verdicts for every built-in study, by its name."""
    found = {source: parts(source) for source in sources()}
    progress.begin("auditing", sum(len(part.entries) for each in found.values() for part in each), "equations")
    checked: dict[str, list[CheckedEquation]] = {source: [] for source in found}
    for source, each in found.items():
        for one in _checked(each, samples):
            checked[source].append(one)
            progress.step()
    return checked


def _checked(found: Iterable[SourceFile], samples: int) -> Iterator[CheckedEquation]:
    faults: dict[str, str] = {}  # by cause: one of a whole file is reported once
    for part in found:
        check = Check(part, samples)
        for entry in part.entries:
            try:
                yield check.check(entry)
            except AuditError as error:
                faults.setdefault(f"{part.path} {error.__cause__}", str(error))
    if faults:
        raise AuditError("\n".join(faults.values()))


def counts(checked: Iterable[CheckedEquation]) -> dict[Verdict, int]:
    """Return the number of equations with each verdict."""
    found = Counter(each.verdict for each in checked)
    return {verdict: found[verdict] for verdict in VERDICTS}


def as_csv(checked: Sequence[CheckedEquation]) -> str:
    """Return the verdicts as comma-separated values with a header; at least one."""
    rows = [_row(each) for each in checked]
    return csv_text([rows[0], *(row.values() for row in rows)])


def _row(checked: CheckedEquation) -> dict[str, str]:
    entry, measured, second = checked.entry, checked.measured, checked.second
    return {
        "source": checked.source,
        "id": entry.id,
        "number": entry.number,
        "place": entry.place,
        "title": entry.title,
        "verdict": checked.verdict,
        "largest_error": f"{measured.largest:.6g}" if measured else "",
        "typical_error": f"{measured.typical:.6g}" if measured else "",
        "largest_error_second_derivation": f"{second.largest:.6g}" if second else "",
        "first_derivation": checked.methods[0],
        "second_derivation": checked.methods[1],
        "unit": entry.unit,
        "tolerance": f"{entry.tolerance:g}",
        "as_printed": _plain(entry.printed),
        "emended": _plain(entry.emendation) if entry.emendation else "",
        "why_emended": entry.emendation.why if entry.emendation else "",
        "corrected": _plain(entry.corrected) if entry.corrected else "",
        "finding": entry.finding,
    }


def _plain(form: Form) -> str:
    return "; ".join(f"{name} = {text}" for name, text in form.elements.items()) or form.math


class Place(StrictModel):
    """A section or page.

    Attributes:
        place: Its name.
        equations: Number or name of each equation printed there, in order.
        lost: Those that are missing in the text although it must have had them.
    """

    place: str
    equations: list[str]
    lost: list[str] = Field(default_factory=list)


class Inventory(StrictModel):
    """Equations of a source by section or page, as the reference for the audit's coverage.

    It is written from the source's text in reading order, independently of the entries. The file is
    `equations/inventory.yaml` in the study's folder:

        counted: one line for each equation with a sign of equality; ...
        places:
          - place: Inverse kinematics, page 8
            equations: [q1, p3, p4, q2, p1, p2, M, q4]
            lost: [..]                 # equations that the text must have had and does not show

    Attributes:
        title: How it is cited.
        found: What is wrong with its equations, and why, in a few sentences; inline mathematics as in reports.
        counted: What counts as an equation, in a sentence.
        places: In order.
    """

    title: str
    found: str
    counted: str
    places: list[Place]


def inventory(where: Where) -> Inventory:
    """Return the inventory of a source."""
    return read_data(source_of(where).equations / "inventory.yaml", Inventory)


def differences(where: Where) -> list[str]:
    """Return the equations that only the inventory or only the audit has, a line each; empty if both are equal."""
    listed = Counter((place.place, number) for place in inventory(where).places for number in place.equations)
    audited = Counter((entry.place, entry.number) for _, entry in entries(where))
    missing = [f"{place}: {number} is not audited" for place, number in (listed - audited).elements()]
    return missing + [f"{place}: {number} is not in the inventory" for place, number in (audited - listed).elements()]
