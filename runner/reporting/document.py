"""Report as plain data: sections of typed blocks, rendered by two templates (HTML and Typst).

Blocks contain values, never markup. A string may contain inline mathematics between dollar signs, in Typst notation
(`"the sag is $g / omega_n^2$"`). Everything else is shown literally, so that a name from a config or a file can never
become markup. A literal dollar sign is written twice. `§2.1` is a link to that section. "claim 3", "figure 3.5" and
"table 2.1" are links if the report contains them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray as FloatArray
from runner.reporting.answer_map import AnswerMap
from runner.reporting.block import ReportBlock as ReportBlock
from runner.reporting.charts.figure import Curves as Curves
from runner.reporting.charts.figure import Map as Map
from runner.reporting.charts.figure import Maps as Maps
from runner.reporting.charts.figure import Panel as Panel
from runner.reporting.charts.figure import Series as Series
from runner.reporting.table import Origin as Origin
from runner.reporting.table import Table as Table


@dataclass(frozen=True)
class Text(ReportBlock):
    """A paragraph; inline mathematics is between dollar signs."""

    block: ClassVar[str] = "text"
    text: str

    def texts(self) -> Iterator[str]:
        """Yield the text."""
        yield self.text


@dataclass(frozen=True)
class Items(ReportBlock):
    """A list of short strings; inline mathematics as in Text."""

    block: ClassVar[str] = "items"
    items: Sequence[str]

    def texts(self) -> Iterator[str]:
        """Yield the items."""
        yield from self.items


@dataclass(frozen=True)
class Code(ReportBlock):
    """A string that is shown as typed, and can be copied.

    Attributes:
        text: The text.
        name: Name of the file that HTML saves it as; then HTML shows it only on a click, and paper does not at all.
    """

    block: ClassVar[str] = "code"
    text: str
    name: str = ""


NoticeKind = Literal["finding", "warning", "failure", "stands", "falls", "turns", "why"]


@dataclass(frozen=True)
class Notice(ReportBlock):
    """A paragraph set apart: a failed run, a limit of the comparison, a finding that contradicts the source.

    Attributes:
        kind: The word before the title.
        title: One sentence.
        text: More sentences; empty for none.
        answer: True if it answers the question that is the title of its chapter.
    """

    block: ClassVar[str] = "notice"
    kind: NoticeKind
    title: str
    text: str
    answer: bool = False

    def texts(self) -> Iterator[str]:
        """Yield the text."""
        yield self.text


@dataclass(frozen=True)
class Formula(ReportBlock):
    """A displayed equation.

    Attributes:
        typst: The equation in Typst mathematics; written by us, never taken from a config or a file.
        number: Its number in the source, such as "3.33", or "" if it has none.
    """

    block: ClassVar[str] = "formula"
    typst: str
    number: str = ""

    def displayed(self) -> Iterator[str]:
        """Yield the equation."""
        yield self.typst


@dataclass(frozen=True)
class RunList(ReportBlock):
    """The runs of a sweep: filtered, sorted and plotted against each other in HTML, a short table in the PDF.

    Attributes:
        caption: What it lists; inline mathematics as in Text.
        axes: Name of each swept axis with the names of its values.
        levels: Index of each run's value on each axis, shape (runs, axes).
        metrics: Name of each metric with its unit; those listed first are shown first.
        values: Median of each metric, shape (runs, metrics); NaN where there is none.
        hashes: Hash of each run.
        failures: Why each run failed, empty for a good one.
        commands: The command of each run.
        folders: Address of each run's folder, seen from the report; empty where it has none.
    """

    block: ClassVar[str] = "runlist"
    word: ClassVar[str] = "figure"
    caption: str
    axes: Sequence[tuple[str, Sequence[str]]]
    levels: NDArray[np.intp]
    metrics: Sequence[tuple[str, str]]
    values: FloatArray
    hashes: Sequence[str]
    failures: Sequence[str]
    commands: Sequence[str]
    folders: Sequence[str]
    origin: Origin = field(default_factory=Origin)

    def texts(self) -> Iterator[str]:
        """Yield the caption."""
        yield self.caption


@dataclass(frozen=True)
class Picture(ReportBlock):
    """A still image, drawn from the model or from a stored run.

    Attributes:
        caption: What is seen; inline mathematics as in Text.
        svg: The image as SVG text.
        alt: Description of the image for screen readers.
        width: Share of the text width, 0 to 1.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "picture"
    word: ClassVar[str] = "figure"
    actions: ClassVar[tuple[str, ...]] = ("enlarge", "svg")
    caption: str
    svg: str
    alt: str
    width: float = 0.7
    origin: Origin = field(default_factory=Origin)

    def texts(self) -> Iterator[str]:
        """Yield the caption."""
        yield self.caption


@dataclass(frozen=True)
class PlaybackBody:
    """One rigid body of a playback: a polyline of the arm, drawn as cylinders and balls in its own frame.

    Attributes:
        name: Name of the link.
        segments: Cylinders as (start, end, radius) in the body frame, in m.
        balls: Spheres as (centre, radius) in the body frame, in m.
        positions: Position of the body frame at each instant, shape (T, 3), in m.
        rotations: Rotation of the body frame as quaternion w, x, y, z at each instant, shape (T, 4).
        color: Index into the palette.
    """

    name: str
    segments: Sequence[tuple[tuple[float, float, float], tuple[float, float, float], float]]
    balls: Sequence[tuple[tuple[float, float, float], float]]
    positions: FloatArray
    rotations: FloatArray
    color: int = 0


@dataclass(frozen=True)
class Playback(ReportBlock):
    """The motion of an arm, and of further ones: played, paused and turned in HTML, a still picture in the PDF.

    Attributes:
        caption: What moves.
        times: Instants of the frames, shape (T,), in s.
        bodies: The moving bodies.
        path: Path of the tip, shape (N, 3), in m.
        desired: Desired path, shape (M, 3), or None.
        still: The motion as a still SVG picture (several instants in one), for the PDF.
        origin: Its number in the source, command and commit.
        name: Name of the run among several.
        ends: Remark if the run ended early, such as "failed at 0.1 s", or "".
        tip: Position of the tip at each instant, shape (T, 3), in m; empty if its error is not shown.
        target: Desired position of the tip at each instant, shape (T, 3), in m.
        joints: Name and position of each joint at each instant, shape (T, 3), in m.
        others: Motions of further runs, which can be chosen or shown as a ghost.
        look: Index into the palette of its path; None for that of an arm, or of a ghost.
        draw: Returns the still picture for a width, in inches, with letters of one size; None to scale the still.
    """

    block: ClassVar[str] = "playback"
    word: ClassVar[str] = "figure"
    actions: ClassVar[tuple[str, ...]] = ("enlarge", "svg", "csv")
    caption: str
    times: FloatArray
    bodies: Sequence[PlaybackBody]
    path: FloatArray
    desired: FloatArray | None
    still: str
    origin: Origin = field(default_factory=Origin)
    name: str = ""
    ends: str = ""
    tip: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    target: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    joints: Mapping[str, FloatArray] = field(default_factory=dict)
    others: Sequence["Playback"] = ()
    look: int | None = None
    draw: Callable[[float], str] | None = field(default=None, repr=False, compare=False)

    def texts(self) -> Iterator[str]:
        """Yield the caption."""
        yield self.caption


@dataclass(frozen=True)
class Provenance(ReportBlock):
    """Provenance of the results: names and values, such as plant, step, versions, machine, commit."""

    block: ClassVar[str] = "provenance"
    rows: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Section:
    """A titled sequence of blocks, with sections below it."""

    title: str
    blocks: Sequence[ReportBlock] = ()
    sections: Sequence["Section"] = ()

    @property
    def answers(self) -> Sequence[Notice]:
        """The notices that answer the question that is its title."""
        return [block for block in self.blocks if isinstance(block, Notice) and block.answer]


@dataclass(frozen=True)
class Cover:
    """The picture of a report's first screen.

    Attributes:
        caption: What is seen.
        moving: It as an SVG that moves, for HTML.
        still: It as an SVG that does not, for paper and for readers who want no motion.
    """

    caption: str
    moving: str
    still: str


@dataclass(frozen=True)
class Document:
    """A whole report.

    Attributes:
        title: Title.
        subtitle: One line below it.
        abstract: The report in a few sentences, each line a paragraph; inline mathematics as in Text.
        sections: The chapters.
        date: Date of its newest run, ISO format, so that a report remade is the same; empty where none is.
        cover: The picture of the first screen.
        key_numbers: Numbers of the first screen: what each is, its value with unit, and what is to be said of it.
        shown: Number of chapters that HTML shows; it folds the others behind "All details". None shows all.
        notes: Lines below the count of verdicts there: what their words mean, caveats; inline mathematics as in Text.
        map: Map of answers, below the first paragraph of the abstract.
        dated: What the date is of.
    """

    title: str
    subtitle: str
    abstract: str
    sections: Sequence[Section]
    date: str
    cover: Cover | None = None
    notes: Sequence[str] = ()
    key_numbers: Sequence[tuple[str, str, str]] = ()
    shown: int | None = None
    map: AnswerMap | None = None
    dated: str = "Newest run"

    @property
    def answers(self) -> Sequence[Notice]:
        """The answers of the first chapter; the report opens with this chapter if there are any."""
        return self.sections[0].answers if self.sections else ()
