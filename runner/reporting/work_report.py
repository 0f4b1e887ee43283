"""What the reports of all works end with: where they come from, and what of the work they hold."""

from collections.abc import Callable, Mapping, Sequence

from runner.reporting.document import Document, Notice, Section, Table, Text
from runner.reporting.expected_caveats import ExpectedCaveat, caveats_section
from runner.reporting.job import Made, MissingError, Thing
from runner.reporting.run_report import literal, provenance
from runner.store import Run


def work_document(
    title: str,
    subtitle: str,
    abstract: str,
    chapters: Sequence[Section],
    behind: str,
    runs: Mapping[str, Run],
    expected: Sequence[ExpectedCaveat],
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
        expected: The caveats that the work expects of them.
        checklist: Makes the last chapter from those before it.
    """
    missing = [_missing(runs.missing)] if isinstance(runs, Made) and runs.missing else []
    where_from = Section("Provenance", (Text(behind), provenance(list(runs.values()))))
    sections = (*missing, *chapters, caveats_section(runs, expected), where_from)
    date = max(str(run.provenance["date"]) for run in runs.values())
    return Document(title, subtitle, abstract, (*sections, checklist(sections)), date)


def parts(made: Mapping[str, Thing], *makers: Callable[[Mapping[str, Thing]], Section]) -> list[Section]:
    """Return chapters or sections, made one by one; one that needs what was not made says so instead.

    Args:
        made: Runs or calibrations by name.
        makers: Functions that make each of them; their names are told where one is left out.
    """
    found = []
    for make in makers:
        try:
            found.append(make(made))
        except MissingError as error:
            name = getattr(make, "func", make).__name__.removesuffix("_section").strip("_").replace("_", " ")
            notice = Notice("failure", "Left out", f"This part needs what was not made: {literal(str(error))}.")
            found.append(Section(f"Left out: {name}", (notice,)))
    return found


def _missing(missing: Mapping[str, str]) -> Section:
    rows = [[literal(name), literal(why)] for name, why in missing.items()]
    table = Table("Not made, and so missing in this report; the same command makes them.", ["name", "why"], rows)
    return Section("What is missing", (table,))
