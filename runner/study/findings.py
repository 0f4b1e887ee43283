"""Findings of a report: sentences with the conditions under which they are true."""

from collections.abc import Iterator
from dataclasses import dataclass

from runner.reporting.document import Document, Notice
from runner.reporting.outline import chapters
from runner.study.measured import Condition


@dataclass(frozen=True)
class Finding(Notice):
    """A conclusion; where a condition of it fails, its notice says so in place of it.

    Attributes:
        conditions: What must be true for its sentences to stand.
        claim: Its title as it was written.
        sentences: Its text as it was written.
    """

    conditions: tuple[Condition, ...] = ()
    claim: str = ""
    sentences: str = ""

    @property
    def holds(self) -> bool:
        """Whether all of it stands."""
        return all(condition.holds for condition in self.conditions)


def finding(title: str, text: str, *holds: Condition) -> Finding:
    """Return a conclusion that says so itself when it is no longer true.

    There is one branch of prose: sentences that are chosen by the numbers contradict each other sooner or later.

    Args:
        title: What was found, in a line.
        text: The sentences; inline mathematics as in Text.
        holds: The conditions under which each of the sentences is true, with a margin.

    Raises:
        ValueError: if there is no condition.
    """
    if not holds:
        raise ValueError(f"finding '{title}': needs one condition or more; what nothing can refute concludes nothing")
    failed = [condition for condition in holds if not condition.holds]
    if not failed:
        return Finding("finding", title, text, holds, title, text)
    reasons = " ".join(f"Not so: {condition.text} ({condition.measured})." for condition in failed)
    return Finding("warning", f"No longer holds: {title}", f"{reasons} It was written: {text}", holds, title, text)


def findings(document: Document) -> Iterator[tuple[str, Finding]]:
    """Yield the conclusions of a report in reading order, each with the number of its section."""
    for chapter in chapters(document):
        for block in chapter.section.blocks:
            if isinstance(block, Finding):
                yield chapter.number, block
