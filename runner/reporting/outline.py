"""Reading order of a report: numbered sections, blocks, strings and formulas."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from runner.reporting.document import (
    Block,
    Curves,
    Document,
    Equations,
    Formula,
    Items,
    Maps,
    Notice,
    Picture,
    Playback,
    RunList,
    Section,
    Table,
    Text,
    Verdicts,
)
from runner.reporting.markup import anchor, spans


@dataclass(frozen=True)
class Chapter:
    """A section with its place in the report.

    Attributes:
        number: Its number, such as "2.1".
        level: 1 for a chapter, 2 for a section of it.
        section: Title and blocks.
    """

    number: str
    level: int
    section: Section

    @property
    def anchor(self) -> str:
        """Name of the place in the page that the table of contents leads to."""
        return anchor(self.number)


def chapters(document: Document) -> list[Chapter]:
    """Return all sections of a document in reading order, numbered."""
    return list(number_sections(document.sections))


def number_sections(sections: Sequence[Section], prefix: str = "") -> Iterator[Chapter]:
    """Yield sections and those below them in reading order, numbered from 1 behind a prefix such as "2."."""
    for index, section in enumerate(sections, start=1):
        number = f"{prefix}{index}"
        yield Chapter(number, number.count(".") + 1, section)
        yield from number_sections(section.sections, number + ".")


def blocks(document: Document) -> Iterator[Block]:
    """Yield all blocks of a document in reading order."""
    for chapter in chapters(document):
        yield from chapter.section.blocks


def formulas(document: Document) -> tuple[list[str], list[str]]:
    """Return the mathematics of a document: displayed equations and inline spans, each once, in reading order."""
    displayed: dict[str, None] = {}
    inline: dict[str, None] = dict.fromkeys(
        formula for text in (document.abstract, *document.notes) for formula in _math(text)
    )
    for block in blocks(document):
        if isinstance(block, Formula):
            displayed[block.typst] = None
        if isinstance(block, Equations):
            inline.update(dict.fromkeys(form.math for row in block.rows for form in row.forms if form.math))
        for text in _texts(block):
            inline.update(dict.fromkeys(_math(text)))
    return list(displayed), list(inline)


def _math(text: str) -> list[str]:
    return [span.text for span in spans(text) if span.math]


def _texts(block: Block) -> Iterator[str]:
    """Yield the texts of a block that may carry inline mathematics."""
    match block:
        case Text() | Notice():
            yield block.text
        case Items():
            yield from block.items
        case Curves() | Maps() | RunList() | Picture() | Playback():
            yield block.caption
        case Table():
            yield block.caption
            yield from block.header
            for row in block.rows:
                yield from row
        case Verdicts():
            yield block.caption
            yield from (claim.reason for claim in block.rows)
        case Equations():
            yield block.caption
            for equation in block.rows:
                yield equation.finding
                yield from (form.note for form in equation.forms)
        case _:
            pass


def count_figures(document: Document) -> int:
    """Return the number of a document's figures that are drawn for the PDF."""
    return sum(isinstance(block, Curves | Maps) for block in blocks(document))
