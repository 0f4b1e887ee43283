"""Scope of a study's findings as a table, for the terminal and for the report."""

from collections.abc import Iterator, Sequence
from textwrap import shorten

from runner.papers.study.challenge import Answer, Challenged
from runner.reporting.challenge.words import TITLES
from runner.reporting.document import ReportBlock, Section, Table, Text
from runner.reporting.markup import literal, without_marks
from runner.statistics.scope import FEWEST
from runner.sweeps.challenge.question import CLASSES

_ABOUT = (
    "Each written condition is asked again with one choice changed at a time, for all runs of the finding. Runs with "
    f"random draws have fresh seeds and at most {FEWEST} repetitions. All findings are asked under numerical choices; "
    "answers that compare runs are asked under equivalent choices and conditions, too. Gains are not tuned again."
)


def scope_table(found: Sequence[Challenged], width: int | None = None) -> Table:
    """Return a row for each finding: section, title, what keeps its condition, what turns it, what cannot be asked.

    Args:
        found: The findings.
        width: Largest number of characters of a title, which has no marks then; None for whole titles.
    """
    header = ["section", "finding", "holds with", "turned by", "cannot be asked with"]
    answers: Sequence[Answer] = ("holds", "turns", "cannot be asked")
    rows = [
        [
            one.number,
            one.title if width is None else shorten(without_marks(one.title), width, placeholder=" ..."),
            *(_labels(one, answer) for answer in answers),
        ]
        for one in found
    ]
    return Table("", header, rows, prose=True)


def turned_lines(found: Sequence[Challenged]) -> Iterator[str]:
    """Yield a line for each failed condition and for each value that moves with a finer step."""
    for one in found:
        for each in one.outcomes:
            if each.answer != "holds":
                yield f"section {one.number}: {each.answer} with {each.label}: {each.why}"
        for text in one.moved:
            yield f"section {one.number}: moves by more than 10 % with a finer step: {text}"


def unsettled(found: Sequence[Challenged]) -> Iterator[str]:
    """Yield a line for each finding that a numerical choice turns."""
    for one in found:
        labels = [each.label for each in one.outcomes if each.kind == "numbers" and each.answer == "turns"]
        if labels:
            title = without_marks(one.title)
            yield f"section {one.number}: {title}: not settled numerically: turned by {', '.join(labels)}"


def scope_section(found: Sequence[Challenged]) -> Section:
    """Return the section of a report on the scope of its findings."""
    blocks: list[ReportBlock] = [Text(_ABOUT), scope_table(found)]
    turned = [
        [one.number, each.label, literal(each.why)] for one in found for each in one.outcomes if each.answer != "holds"
    ]
    if turned:
        blocks.append(Table("Conditions that a variation turns.", ["section", "changed", "found"], turned, prose=True))
    moved = [[one.number, literal(text)] for one in found for text in one.moved]
    if moved:
        caption = "Values that move by more than 10 % with a finer step."
        blocks.append(Table(caption, ["section", "value"], moved, prose=True))
    left = [
        [one.number, CLASSES[each.kind], f"{TITLES.get(each.family, each.family)}: {literal(each.reason)}"]
        for one in found
        for each in one.left_out
    ]
    if left:
        blocks.append(Table("Left out.", ["section", "class", "choice"], left, prose=True))
    return Section("Scope of the findings", blocks)


def _labels(one: Challenged, answer: Answer) -> str:
    """Return the changes with an answer; the title of a family if all of its values have it."""
    if answer == "holds" and not one.outcomes:
        return "not asked"
    texts = []
    for each in one.outcomes:
        if each.answer == answer:
            whole = all(other.answer == answer for other in one.outcomes if other.family == each.family)
            texts.append(TITLES.get(each.family, each.label) if whole else each.label)
    return ", ".join(dict.fromkeys(texts))
