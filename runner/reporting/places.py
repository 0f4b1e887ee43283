"""Link targets of a report: sections, claims, and figures and tables of the source."""

import re

from runner.reporting.document import Block, Curves, Document, Equations, Maps, Origin, Playback, Table, Verdicts
from runner.reporting.outline import Chapter, chapters

_NUMBERED = re.compile(r"(?:(figure|fig\.?|table) )?(\d+(?:\.\d+)*[a-z]?)", re.IGNORECASE)
_EXPERIMENT = re.compile(r"experiment=(\S+)")


class Places:
    """Where links of a report lead to.

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

    def _place(self, chapter: Chapter, block: Block, origin: Origin, count: int) -> None:
        if isinstance(block, Verdicts):
            self.names |= {claim_place(row.number) for row in block.rows}
        if isinstance(block, Equations):
            self.names |= {verdict_place(block.source, row.verdict) for row in block.rows}
        kind = "table" if block.block in ("table", "equations", "verdicts") else "figure"
        name = numbered_place(origin.number, kind)
        if not name or name in self.names:
            name = f"{chapter.anchor}-{kind}-{count}"
        self.names.add(name)
        self._of[id(block)] = name
        if isinstance(block, Curves | Maps | Playback):
            self._evidence.setdefault(_experiment(origin.command), name)

    def of(self, block: Block) -> str:
        """Return the name of a block's place; nothing where it is no figure or table."""
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


def claim_place(number: str) -> str:
    """Return the name of the place of a claim."""
    return f"claim-{number}"


def verdict_place(source: str, verdict: str) -> str:
    """Return the name of the place of the equations of a source that have a verdict."""
    return re.sub(r"\W+", "-", f"{source} {verdict}").strip("-")
