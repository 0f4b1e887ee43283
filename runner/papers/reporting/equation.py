"""Printed equations in a report: forms, verdict, reading order and the scripts of their names."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal

from runner.reporting.block import ReportBlock
from runner.reporting.markup import literal
from runner.reporting.table import Origin
from runner.reporting.verdicts import Tally, VerdictSquare

EquationVerdict = Literal["correct", "correct after emendation", "wrong as printed", "unreadable", "definition"]

SHOWN: tuple[EquationVerdict, ...] = ("wrong as printed", "unreadable", "correct after emendation")
"""Verdicts that need a look, in the order of reading."""
FOLDED: tuple[EquationVerdict, ...] = ("correct", "definition")
"""Verdicts that need none: the page folds their equations, paper lists their names."""
_NAME = re.compile(
    r"(?<!\w)(?P<frame>\d?)(?P<letter>[^\W\d_])"
    r"(?:_(?P<below>[^\W_]+(?:,\d\d)?)|(?P<digits>\d+)|(?P<difference>\(\d(?:-\d)+\)))?"
    r"(?:\^(?P<above>[\w+]+))?(?![\w\^])"
)


@dataclass(frozen=True)
class EquationForm:
    """One form of an equation: as printed, emended, corrected. It has lines of formulas, or raw text, or neither.

    Attributes:
        label: Which form it is.
        lines: Formulas in Typst mathematics; a line can have several. Differences from the form next to it are in
            `differs(...)`.
        raw: The source text, if it cannot be read, in pieces; the flag says whether a piece is marked.
        note: Reason of the emendation, or what it is; inline mathematics as in Text.
        whole: All of it on one line, where the rest shows a part; the page folds it.
    """

    label: str
    lines: Sequence[Sequence[str]] = ()
    raw: Sequence[tuple[bool, str]] = ()
    note: str = ""
    whole: str = ""


@dataclass(frozen=True)
class Equation:
    """A printed equation with its verdict.

    Attributes:
        number: Its number or name in the source.
        title: What it is.
        place: Section or page.
        verdict: What the samples say.
        error: Largest and typical error, formatted with unit, or "".
        forms: As printed first, then emended and corrected.
        finding: Description of the fault; inline mathematics as in Text.
    """

    number: str
    title: str
    place: str
    verdict: EquationVerdict
    error: str
    forms: Sequence[EquationForm]
    finding: str = ""

    @property
    def name(self) -> str:
        """The number or name as inline text."""
        return name_text(self.number)


@dataclass(frozen=True)
class Equations(ReportBlock):
    """Audited equations, those that are wrong first; the HTML page can be searched, and folds those that are right.

    Attributes:
        caption: What it lists; inline mathematics as in Text.
        rows: The equations, in the order of the text.
        origin: Its number in the source, command and commit.
        source: What the source of the equations is called.
        data: Address of a file next to the report that has all of them, or "".
    """

    block: ClassVar[str] = "equations"
    templates: ClassVar[str] = "papers"
    word: ClassVar[str] = "table"
    caption: str
    rows: Sequence[Equation]
    origin: Origin = field(default_factory=Origin)
    source: str = ""
    data: str = ""

    @property
    def shown(self) -> list[tuple[str, str, int, list[tuple[str, list[Equation]]]]]:
        """Each verdict that needs a look, with its place, its number of equations, and these by finding."""
        return [(verdict, place, len(rows), by_finding(rows)) for verdict, place, rows in self._with_verdicts(SHOWN)]

    @property
    def folded(self) -> list[tuple[str, str, int, list[tuple[str, list[Equation]]]]]:
        """Each verdict that needs none, with its place, its number of equations, and these by place."""
        return [(verdict, place, len(rows), by_place(rows)) for verdict, place, rows in self._with_verdicts(FOLDED)]

    def _with_verdicts(self, verdicts: Iterable[str]) -> Iterator[tuple[str, str, list[Equation]]]:
        for verdict in verdicts:
            if rows := [row for row in self.rows if row.verdict == verdict]:
                yield verdict, self._place(verdict), rows

    def _place(self, verdict: str) -> str:
        return re.sub(r"\W+", "-", f"{self.source} {verdict}").strip("-")

    def texts(self) -> Iterator[str]:
        """Yield the caption, and of each equation the name, the finding and the notes."""
        yield self.caption
        for row in self.rows:
            yield from (row.name, row.finding, *(form.note for form in row.forms))

    def inline(self) -> Iterator[str]:
        """Yield the formulas."""
        for row in self.rows:
            for form in row.forms:
                yield from (formula for line in form.lines for formula in line)

    def places(self) -> Iterable[str]:
        """Return the names of the places of the verdicts."""
        return {self._place(row.verdict) for row in self.rows}

    def tallies(self) -> Iterable[Tally]:
        """Yield the count of each verdict."""
        squares = [
            VerdictSquare(str(len(rows)), verdict, place, f"{len(rows)} {verdict}")
            for verdict, place, rows in self._with_verdicts((*SHOWN, *FOLDED))
        ]
        yield Tally.of(self.source or "equations", squares, [row.verdict for row in self.rows])


def by_finding(rows: Iterable[Equation]) -> list[tuple[str, list[Equation]]]:
    """Return equations with the finding, or the emendation: those with the same finding are together, and lose it."""
    found: dict[str, list[Equation]] = {}
    for place, row in enumerate(rows):
        found.setdefault(row.finding or _note(row) or f"none {place}", []).append(row)
    return [(each[0].finding or _note(each[0]), [_without_words(row) for row in each]) for each in found.values()]


def _note(row: Equation) -> str:
    return " ".join(form.note for form in row.forms if form.note and len(row.forms) == 2)


def _without_words(row: Equation) -> Equation:
    if row.finding or not _note(row):
        return replace(row, finding="")
    return replace(row, forms=[replace(form, note="") for form in row.forms])


def by_place(rows: Iterable[Equation]) -> list[tuple[str, list[Equation]]]:
    """Return each place of the source with its equations."""
    found: dict[str, list[Equation]] = {}
    for row in rows:
        found.setdefault(row.place, []).append(row)
    return list(found.items())


def name_text(name: str) -> str:
    """Return the name of an equation as inline text, with the letters that have scripts as mathematics."""
    found, end = "", 0
    for match in _NAME.finditer(name):
        below = match["below"] or match["digits"] or (match["difference"] or "").replace("-", "−")
        if match["frame"] or below or match["above"]:
            scripts = {"tl": match["frame"], "br": below, "tr": match["above"]}
            told = "".join(f', {place}: "{script}"' for place, script in scripts.items() if script)
            found += f'{literal(name[end : match.start()])}$attach(italic("{match["letter"]}"){told})$'
            end = match.end()
    return found + literal(name[end:])
