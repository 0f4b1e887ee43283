"""Reader of a chapter file: expressions, then containers, then Markdown."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from runner.base.errors import nearest, unknown
from runner.papers.study.measured import ANSWERS, Condition, Finding, finding
from runner.papers.study.prose.expressions import ChapterValues, ProseError
from runner.papers.study.prose.paragraphs import Heading, Paragraphs, Piece
from runner.reporting.document import NoticeKind, ReportBlock, Section, Text

_CONTAINERS = ("finding", *ANSWERS)
_FENCE = ":::"
_HOLDS, _ABOUT = re.compile(r"\s*holds:(.*)"), re.compile(r"about:(.*)")
ABOUT = ("engine", "step", "seeds")
"""Choices that a finding may compare itself."""


@dataclass(frozen=True)
class Stated:
    """A condition as written in a chapter.

    Attributes:
        expression: Its expression.
        line: Its line, counted from 1.
    """

    expression: str
    line: int


@dataclass(frozen=True)
class Box:
    """A finding as written in a chapter.

    Attributes:
        finding: The finding.
        stated: Its conditions.
        about: Choices that it compares itself, such as "engine".
        read: Names of the results that its conditions have read.
    """

    finding: Finding
    stated: Sequence[Stated]
    about: Sequence[str]
    read: frozenset[str]


@dataclass(frozen=True)
class Reading:
    """Content of a chapter's file.

    Attributes:
        section: Its section.
        values: The values of its expressions.
        boxes: Its findings as written.
    """

    section: Section
    values: ChapterValues
    boxes: list[Box]

    @property
    def stated(self) -> list[Stated]:
        """The conditions of all findings."""
        return [each for box in self.boxes for each in box.stated]


@dataclass
class _Container:
    """A box that is being read: kind, where it begins in file and among the lines read, title, lines, conditions."""

    kind: NoticeKind
    line: int
    count: int
    title: str
    lines: list[str] = field(default_factory=list)
    conditions: list[Stated] = field(default_factory=list)
    about: list[str] = field(default_factory=list)


def read_chapter(
    file: str, text: str, names: Mapping[str, Any], handed: tuple[type, ...] = (), read: set[str] | None = None
) -> Reading:
    """Return the content of a chapter's file.

    Its first line is its title, `# Title`; `## Title` begins a section of it. `{{ CALL }}` in a separate paragraph is
    a block, a list of blocks or a section, anywhere else a value in the sentence; `{% set name = EXPRESSION %}` at the
    begin of a line gives a value a name. A conclusion is written in a box:

        ::: finding Taking turns does harm
        The error is {{ turns }}, that of both arms at once {{ both }}.
        holds: turns > 10 * both
        :::

    The boxes `stands`, `falls`, `turns` and `why` answer the question that is the title of the chapter. Their text
    may be empty. A finding that compares engines or steps says so by a line `about: engine, step`: a challenge leaves
    these choices as they are.

    Args:
        file: Name of the file, for messages.
        text: Its content.
        names: What expressions may call and read, by name.
        handed: Further classes whose values they hand on as they are.
        read: Names of the results that expressions have read; the results add to it.

    Raises:
        ProseError: if it cannot be read; names the line, and what to write.
    """
    values = ChapterValues(file, names, handed, read)
    boxes: list[Box] = []
    pieces = list(_pieces(file, values.put_away(text), values, boxes))
    if not pieces or not isinstance(pieces[0], Heading) or pieces[0].level != 1:
        raise ProseError(file, 1, "begins without a title; write `# Title` in the first line")
    return Reading(_section(file, pieces), values, boxes)


def _pieces(file: str, text: str, values: ChapterValues, boxes: list[Box]) -> Iterator[Piece]:
    """Yield headings, blocks and findings in reading order."""
    paragraphs = Paragraphs(file, values)
    plain: list[str] = []
    first, box = 1, None
    for count, line in enumerate(text.splitlines(), start=1):
        number = values.line_of(count)
        condition, about = _HOLDS.match(line), _ABOUT.match(line)
        if line.startswith(_FENCE):
            if box is None:
                yield from paragraphs.blocks("\n".join(plain), first)
                box = _opened(file, line, number, count)
            elif line.strip() == _FENCE:
                found = _finding(file, box, values, paragraphs)
                read = frozenset[str]().union(*(values.read_by(each.expression) for each in box.conditions))
                boxes.append(Box(found, box.conditions, box.about, read))
                yield found
                plain, first, box = [], count + 1, None
            else:
                raise ProseError(file, number, f"a box in a box; close that of line {box.line} by `:::` first")
        elif condition and box is None:
            raise ProseError(file, number, "a condition outside a box; write `holds:` between `::: finding` and `:::`")
        elif about and box is not None:
            box.about += _about(file, about[1], number)
            box.lines.append("")
        elif condition and box is not None:
            box.conditions.append(Stated(condition[1].strip(), number))
            box.lines.append("")
        else:
            (plain if box is None else box.lines).append(line)
    if box is not None:
        raise ProseError(file, box.line, "a box that is not closed; write `:::` on a separate line after it")
    yield from paragraphs.blocks("\n".join(plain), first)


def _opened(file: str, line: str, number: int, count: int) -> _Container:
    kind, _, title = line.removeprefix(_FENCE).strip().partition(" ")
    known = next((each for each in _CONTAINERS if each == kind), None)
    if known is None:
        boxes = ", ".join(_CONTAINERS)
        raise ProseError(file, number, f"no box '{kind}'{nearest(kind, _CONTAINERS)}; boxes: {boxes}")
    if not title:
        raise ProseError(file, number, f"a box without a title; write `::: {kind} TITLE`")
    return _Container(known, number, count, title.strip())


def _about(file: str, text: str, number: int) -> list[str]:
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in ABOUT:
            raise ProseError(file, number, unknown("choice", name, ABOUT, "about"))
    return names


def _finding(file: str, box: _Container, values: ChapterValues, paragraphs: Paragraphs) -> Finding:
    conditions = [own for stated in box.conditions for own in conditions_of(file, stated, values)]
    if not conditions:
        raise ProseError(file, box.line, "a finding without a condition; write `holds: EXPRESSION` for each sentence")
    blocks = list(paragraphs.blocks("\n".join(box.lines), box.count + 1))
    answered = box.kind in ANSWERS and not blocks
    if not answered and not (blocks and all(isinstance(block, Text) for block in blocks)):
        raise ProseError(file, box.line, "a finding contains only sentences; put blocks before or after it")
    text = " ".join(block.text for block in blocks if isinstance(block, Text))
    return finding(paragraphs.title(box.title, box.line), text, *conditions, kind=box.kind)


def conditions_of(
    file: str, stated: Stated, values: ChapterValues, instead: Mapping[str, Any] | None = None
) -> list[Condition]:
    """Return the condition that an expression states, or each of a list of them.

    Args:
        file: Name of the chapter's file.
        stated: The condition as written.
        values: The values of the chapter.
        instead: Values that replace those of some of its names.

    Raises:
        ProseError: if it states none.
    """
    given = values.value(stated.expression, stated.line, instead)
    conditions = given if isinstance(given, list | tuple) else [given]
    if not conditions or not all(isinstance(each, Condition) for each in conditions):
        what = f"gives {type(given).__name__}, no condition; compare measured values"
        raise ProseError(file, stated.line, f"holds: {stated.expression}: {what}")
    return list(conditions)


def _section(file: str, pieces: list[Piece]) -> Section:
    """Return the section that begins with a heading, with those below it."""
    heading = pieces[0]
    assert isinstance(heading, Heading)  # noqa: S101 - ensured by the callers
    blocks: list[ReportBlock] = []
    below: list[list[Piece] | Section] = []
    for piece in pieces[1:]:
        if isinstance(piece, Heading) and piece.level <= heading.level:
            raise ProseError(file, piece.line, f"a second title; sections of a chapter begin with {'#' * 2}")
        if isinstance(piece, Heading) and piece.level == heading.level + 1:
            below.append([piece])
        elif isinstance(piece, Section) and heading.level == 1:
            below.append(piece)
        elif below and isinstance(below[-1], list):
            below[-1].append(piece)
        elif isinstance(piece, Section) or below:
            raise ProseError(file, heading.line, f"'{heading.title}': put sections after the blocks of the chapter")
        elif isinstance(piece, Heading):
            raise ProseError(file, piece.line, f"leaves out a level; write {'#' * (heading.level + 1)} {piece.title}")
        else:
            blocks.append(piece)
    sections = (each if isinstance(each, Section) else _section(file, each) for each in below)
    return Section(heading.title, tuple(blocks), tuple(sections))
