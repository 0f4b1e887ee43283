"""Reading order of a report, and its link targets: sections, claims, figures and tables."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from runner.reporting.document import Curves, Document, Maps, Origin, Playback, ReportBlock, Section, Table
from runner.reporting.markup import anchor, spans
from runner.reporting.verdicts import Tally

_NUMBERED = re.compile(r"(?:(figure|fig\.?|table) )?(\d+(?:\.\d+)*[a-z]?)", re.IGNORECASE)
_EXPERIMENT = re.compile(r"experiment=(\S+)")


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


def blocks(document: Document) -> Iterator[ReportBlock]:
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
        displayed.update(dict.fromkeys(block.displayed()))
        inline.update(dict.fromkeys(block.inline()))
        for text in block.texts():
            inline.update(dict.fromkeys(_math(text)))
    return list(displayed), list(inline)


def _math(text: str) -> list[str]:
    return [span.text for span in spans(text) if span.math]


def tallies(document: Document) -> list[Tally]:
    """Return the counts of verdicts of a report, in reading order."""
    return [tally for block in blocks(document) for tally in block.tallies()]


def count_figures(document: Document) -> int:
    """Return the number of a document's figures that are drawn for the PDF."""
    return sum(isinstance(block, Curves | Maps) for block in blocks(document))


class Places:
    """Targets of the links of a report.

    Args:
        document: The report.

    Attributes:
        names: All names.
    """

    def __init__(self, document: Document) -> None:
        everything = chapters(document)
        self.names = {chapter.anchor for chapter in everything}
        self._of: dict[int, str] = {}
        self._evidence: dict[str, str] = {}
        tables: dict[str, str] = {}
        for chapter in everything:
            captioned = [(block, block.origin) for block in chapter.section.blocks if hasattr(block, "origin")]
            for count, (block, origin) in enumerate(captioned, start=1):
                self._place(chapter, block, origin, count)
                if isinstance(block, Table):
                    tables.setdefault(_experiment(origin.command), self._of[id(block)])
        self._evidence = tables | self._evidence  # a table is evidence where no figure is

    def _place(self, chapter: Chapter, block: ReportBlock, origin: Origin, count: int) -> None:
        self.names |= {*block.places()}
        name = numbered_place(origin.number, block.word)
        if not name or name in self.names:
            name = f"{chapter.anchor}-{block.word}-{count}"
        self.names.add(name)
        self._of[id(block)] = name
        if isinstance(block, Curves | Maps | Playback):
            self._evidence.setdefault(_experiment(origin.command), name)

    def of(self, block: ReportBlock) -> str:
        """Return the name of a block's place; nothing for other blocks."""
        return self._of.get(id(block), "")

    def evidence(self, command: str) -> str:
        """Return the place of what a report shows of a command's experiment; nothing where it shows none."""
        experiment = _experiment(command)
        return self._evidence.get(experiment, "") if experiment else ""


def _experiment(command: str) -> str:
    found = _EXPERIMENT.search(command)
    return found[1] if found else ""


def numbered_place(number: str, kind: str) -> str:
    """Return the name of the place of a numbered figure or table, such as "figure-3-5"; nothing where it has none.

    Args:
        number: Its number in the source, such as "3.5", or with the word before it.
        kind: "figure" or "table", where the number has no word.
    """
    found = _NUMBERED.fullmatch(number.strip())
    if found is None:
        return ""
    word = (found[1] or kind).lower()
    return f"{'table' if word == 'table' else 'figure'}-{found[2].replace('.', '-')}"
