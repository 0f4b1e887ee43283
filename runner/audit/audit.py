"""The whole audit: every equation of the sources judged, and what the audit says of them as a CSV."""

import csv
import io
from collections import Counter
from collections.abc import Iterable, Sequence

from runner.audit.entry import Form, parts
from runner.audit.sources import sources, truth_of
from runner.audit.verdict import SAMPLES, VERDICTS, Judge, Judged, Verdict
from runner.texts import table_cell

_COLUMNS = (
    "source",
    "id",
    "number",
    "place",
    "title",
    "verdict",
    "largest_error",
    "typical_error",
    "largest_error_second_way",
    "one_way",
    "another_way",
    "unit",
    "tolerance",
    "as_printed",
    "repaired",
    "why_repaired",
    "corrected",
    "finding",
)


def audit(source: str, samples: int = SAMPLES) -> list[Judged]:
    """Return the verdict on every equation of a source, in the order of the text.

    Args:
        source: Name of the work.
        samples: How many configurations each is tried at.

    Raises:
        AuditError: If an entry contradicts itself.
    """
    return [judged for part in parts(source) for judged in map(Judge(part, samples).judge, part.entries)]


def audit_all(samples: int = SAMPLES) -> dict[str, list[Judged]]:
    """Return the same for every source, by its name."""
    return {source: audit(source, samples) for source in sources()}


def counts(judged: Iterable[Judged]) -> dict[Verdict, int]:
    """Return how many equations have each verdict."""
    found = Counter(each.verdict for each in judged)
    return {verdict: found[verdict] for verdict in VERDICTS}


def as_csv(judged: Sequence[Judged]) -> str:
    """Return the verdicts as comma-separated values with a header."""
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(_COLUMNS)
    for each in judged:
        entry, measured, second = each.entry, each.measured, each.second
        ways = truth_of(each.source, entry.truth).ways if entry.truth else ("", "")
        cells = [
            each.source,
            entry.id,
            entry.number,
            entry.place,
            entry.title,
            each.verdict,
            f"{measured.largest:.6g}" if measured else "",
            f"{measured.typical:.6g}" if measured else "",
            f"{second.largest:.6g}" if second else "",
            *ways,
            entry.unit,
            f"{entry.tolerance:g}",
            _plain(entry.printed),
            _plain(entry.repair) if entry.repair else "",
            entry.repair.why if entry.repair else "",
            _plain(entry.corrected) if entry.corrected else "",
            entry.finding,
        ]
        table.writerow(map(table_cell, cells))
    return stream.getvalue()


def _plain(form: Form) -> str:
    return "; ".join(f"{name} = {text}" for name, text in form.elements.items()) or form.math
