"""Verdicts on every equation of a source, and their table as CSV."""

import csv
import io
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from runner.audit.entry import Form, Part, parts
from runner.audit.sources import Where, sources
from runner.audit.verdict import SAMPLES, VERDICTS, Judge, Judged, Verdict
from runner.base import progress
from runner.base.progress.stages import AUDITING
from runner.base.sanitize import table_cell


def audit(where: Where, samples: int = SAMPLES) -> list[Judged]:
    """Return the verdict on every equation of a source, in the order of the text.

    Args:
        where: Name of a work of ours, or a folder, as in audit(Path("my_paper")); see `sources.py`.
        samples: How many configurations each is tried at.

    Raises:
        RunnerError: If there is no such source, a file does not fit its format, or what it names does not exist.
        AuditError: If an entry contradicts itself.
    """
    return list(_judged(parts(where), samples))


def audit_all(samples: int = SAMPLES) -> dict[str, list[Judged]]:
    """Return the same for every work of ours, by its name."""
    found = {source: parts(source) for source in sources()}
    progress.begin(AUDITING, None, sum(len(part.entries) for each in found.values() for part in each), "equations")
    judged: dict[str, list[Judged]] = {source: [] for source in found}
    for source, each in found.items():
        for one in _judged(each, samples):
            judged[source].append(one)
            progress.step()
    return judged


def _judged(found: Iterable[Part], samples: int) -> Iterator[Judged]:
    return (judged for part in found for judged in map(Judge(part, samples).judge, part.entries))


def counts(judged: Iterable[Judged]) -> dict[Verdict, int]:
    """Return how many equations have each verdict."""
    found = Counter(each.verdict for each in judged)
    return {verdict: found[verdict] for verdict in VERDICTS}


def as_csv(judged: Sequence[Judged]) -> str:
    """Return the verdicts as comma-separated values with a header; at least one."""
    stream, rows = io.StringIO(), [_row(each) for each in judged]
    table = csv.writer(stream, lineterminator="\n")
    table.writerows([list(rows[0]), *(map(table_cell, row.values()) for row in rows)])
    return stream.getvalue()


def _row(judged: Judged) -> dict[str, str]:
    entry, measured, second = judged.entry, judged.measured, judged.second
    return {
        "source": judged.source,
        "id": entry.id,
        "number": entry.number,
        "place": entry.place,
        "title": entry.title,
        "verdict": judged.verdict,
        "largest_error": f"{measured.largest:.6g}" if measured else "",
        "typical_error": f"{measured.typical:.6g}" if measured else "",
        "largest_error_second_way": f"{second.largest:.6g}" if second else "",
        "one_way": judged.ways[0],
        "another_way": judged.ways[1],
        "unit": entry.unit,
        "tolerance": f"{entry.tolerance:g}",
        "as_printed": _plain(entry.printed),
        "repaired": _plain(entry.repair) if entry.repair else "",
        "why_repaired": entry.repair.why if entry.repair else "",
        "corrected": _plain(entry.corrected) if entry.corrected else "",
        "finding": entry.finding,
    }


def _plain(form: Form) -> str:
    return "; ".join(f"{name} = {text}" for name, text in form.elements.items()) or form.math
