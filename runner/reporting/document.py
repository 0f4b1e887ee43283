"""A report as plain data: sections of typed blocks, made once and rendered by two templates (HTML and Typst).

Blocks hold values, never markup. Text may carry inline mathematics between dollar signs, written as Typst
mathematics (`"the sag is $g / omega_n^2$"`); everything else is shown literally, so that a name from a config
or a file can never become markup. A dollar sign is written as two. `§2.1` is a link to that section.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from runner.drawing.figure import FloatArray as FloatArray
from runner.drawing.figure import Map as Map
from runner.drawing.figure import Panel as Panel
from runner.drawing.figure import Series as Series
from runner.expressions.tree import Node
from runner.reporting.claim import Claim, EquationVerdict


@dataclass(frozen=True)
class Text:
    """A paragraph; inline mathematics stands between dollar signs."""

    block: ClassVar[str] = "text"
    text: str


@dataclass(frozen=True)
class Items:
    """A list of short texts; inline mathematics as in Text."""

    block: ClassVar[str] = "items"
    items: Sequence[str]


@dataclass(frozen=True)
class Notice:
    """A paragraph set apart: a failed run, a limit of the comparison, a finding that contradicts the source."""

    block: ClassVar[str] = "notice"
    kind: Literal["finding", "warning", "failure"]
    title: str
    text: str


@dataclass(frozen=True)
class Formula:
    """A displayed equation.

    Attributes:
        typst: The equation in Typst mathematics; written by us, never taken from a config or a file.
        spoken: The equation in words, for screen readers.
        number: Its number in the source, such as "3.33", or "" where it is ours.
    """

    block: ClassVar[str] = "formula"
    typst: str
    spoken: str
    number: str = ""


@dataclass(frozen=True)
class Origin:
    """Where a figure or table comes from: its number in the source, the command that makes it, the commit."""

    number: str = ""
    command: str = ""
    commit: str = ""


@dataclass(frozen=True)
class Curves:
    """A figure of curves: interactive in HTML (zoom, hover, legend toggles), a still in the PDF.

    Attributes:
        caption: What is seen, in a sentence; inline mathematics as in Text.
        panels: The axes, in reading order.
        columns: How many panels stand beside each other.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "curves"
    caption: str
    panels: Sequence[Panel]
    columns: int = 2
    origin: Origin = field(default_factory=Origin)


@dataclass(frozen=True)
class Maps:
    """Heat maps with one scale of colours: interactive in HTML, a still in the PDF.

    Attributes:
        caption: What is seen, in a sentence; inline mathematics as in Text.
        value_label: What the colours mean, with unit.
        panels: The maps, in reading order.
        log: Whether the colours follow the logarithm.
        columns: How many maps stand beside each other.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "maps"
    caption: str
    value_label: str
    panels: Sequence[Map]
    log: bool = False
    columns: int = 2
    origin: Origin = field(default_factory=Origin)


@dataclass(frozen=True)
class RunList:
    """The runs of a sweep: filtered, sorted and plotted against each other in HTML, a short table in the PDF.

    Attributes:
        caption: What it lists; inline mathematics as in Text.
        axes: Name of each swept axis with the names of its values.
        levels: Index of each run's value on each axis, shape (runs, axes).
        metrics: Name of each metric with its unit; those listed first are shown first.
        values: Median of each metric, shape (runs, metrics); NaN where there is none.
        hashes: Hash of each run.
        failures: Why each run failed, empty for a good one.
        commands: The command that makes each run.
        folders: Address of each run's folder, seen from the report; empty where it has none.
    """

    block: ClassVar[str] = "runlist"
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


@dataclass(frozen=True)
class Picture:
    """A still image, drawn from the model or from a stored run.

    Attributes:
        caption: What is seen; inline mathematics as in Text.
        svg: The image as SVG text.
        alt: The image in words, for screen readers.
        width: Share of the text width, 0 to 1.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "picture"
    caption: str
    svg: str
    alt: str
    width: float = 0.7
    origin: Origin = field(default_factory=Origin)


@dataclass(frozen=True)
class Table:
    """A table of texts; inline mathematics as in Text, in header and cells.

    Attributes:
        caption: What it lists.
        header: Column titles, with units.
        rows: Cells, one sequence per row, each as long as the header.
        numeric: Indices of the columns that hold numbers, set flush right.
        origin: Its number in the source, command and commit.
        code: Indices of the columns that hold what is typed on the command line, set in monospace.
    """

    block: ClassVar[str] = "table"
    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    numeric: Sequence[int] = ()
    origin: Origin = field(default_factory=Origin)
    code: Sequence[int] = ()


@dataclass(frozen=True)
class EquationForm:
    """One form of an equation: as printed, after repair, corrected. It has expressions, or mathematics, or neither.

    Attributes:
        label: Which form it is.
        expressions: Left side and expression of each element.
        math: The equation in Typst mathematics.
        raw: The text as it stands, where it cannot be read.
        note: Why it was mended; inline mathematics as in Text.
    """

    label: str
    expressions: Sequence[tuple[Node, Node]] = ()
    math: str = ""
    raw: str = ""
    note: str = ""


@dataclass(frozen=True)
class Equation:
    """A printed equation with its verdict.

    Attributes:
        number: Its number or name in the source.
        title: What it is.
        place: Section or page.
        verdict: What the samples say.
        error: Largest and typical error, formatted with unit, or "".
        forms: As printed first, then repaired and corrected.
        finding: What is wrong, in words; inline mathematics as in Text.
    """

    number: str
    title: str
    place: str
    verdict: EquationVerdict
    error: str
    forms: Sequence[EquationForm]
    finding: str = ""


@dataclass(frozen=True)
class Equations:
    """A table of audited equations, which the HTML page can be searched by.

    Attributes:
        caption: What it lists.
        rows: The equations, in the order of the text.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "equations"
    caption: str
    rows: Sequence[Equation]
    origin: Origin = field(default_factory=Origin)


@dataclass(frozen=True)
class Body:
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
class Playback:
    """The motion in three dimensions: played, paused and scrubbed in HTML, a still picture in the PDF.

    Attributes:
        caption: What moves.
        times: Instants of the frames, shape (T,), in s.
        bodies: The moving bodies.
        path: Path of the tip, shape (N, 3), in m.
        desired: Desired path, shape (M, 3), or None.
        still: The motion as a still SVG picture (several instants in one), for the PDF.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "playback"
    caption: str
    times: FloatArray
    bodies: Sequence[Body]
    path: FloatArray
    desired: FloatArray | None
    still: str
    origin: Origin = field(default_factory=Origin)


@dataclass(frozen=True)
class Provenance:
    """What made the results: names and values, such as plant, step, versions, machine, commit."""

    block: ClassVar[str] = "provenance"
    rows: Sequence[tuple[str, str]]


Block = (
    Text
    | Items
    | Notice
    | Formula
    | Curves
    | Maps
    | RunList
    | Picture
    | Table
    | Claim
    | Equations
    | Playback
    | Provenance
)


@dataclass(frozen=True)
class Section:
    """A titled sequence of blocks, with sections below it."""

    title: str
    blocks: Sequence[Block] = ()
    sections: Sequence["Section"] = ()


@dataclass(frozen=True)
class Document:
    """A whole report.

    Attributes:
        title: Title.
        subtitle: One line below it.
        abstract: The report in a few sentences; inline mathematics as in Text.
        sections: The chapters.
        date: Date of the newest run behind it, ISO format, so that a report remade is the same; empty where none is.
    """

    title: str
    subtitle: str
    abstract: str
    sections: Sequence[Section]
    date: str
