"""What the reports of all works end with: where they come from, and what of the work they hold."""

from collections.abc import Callable, Mapping, Sequence

from runner.reporting.document import Document, Section, Text
from runner.reporting.run_report import provenance
from runner.store import Run


def work_document(
    title: str,
    subtitle: str,
    abstract: str,
    chapters: Sequence[Section],
    behind: str,
    runs: Mapping[str, Run],
    checklist: Callable[[Sequence[Section]], Section],
) -> Document:
    """Return the report on a published work.

    Args:
        title: The work's title.
        subtitle: Whose it is.
        abstract: What comes out; inline mathematics as in Text.
        chapters: The report's own chapters.
        behind: What lies behind it, for the chapter on provenance.
        runs: The stored runs of the work's plan, by name.
        checklist: Makes the last chapter from those before it.
    """
    sections = (*chapters, Section("Provenance", (Text(behind), provenance(list(runs.values())))))
    date = max(str(run.provenance["date"]) for run in runs.values())
    return Document(title, subtitle, abstract, (*sections, checklist(sections)), date)
