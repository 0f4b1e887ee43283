"""Sheets of static drawings: width, letters, strings broken to fit, and file output."""

import io
import math
import re
import textwrap
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text

from runner.base.quantities import bind_label
from runner.base.sanitize import plain
from runner.schema.units import is_number

LINES = {
    "axes.linewidth": 0.5,
    "axes.edgecolor": "#555b66",
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "svg.fonttype": "path",
    "svg.hashsalt": "runner",
}
"""Parameters of matplotlib that all drawings share."""
_SIZES = ("font.size", "axes.labelsize", "xtick.labelsize", "ytick.labelsize", "legend.fontsize")
_MM = 25.4  # in an inch
_DESIGNED = 7.0  # pt, for which the measures below are made
_LONGEST = 28  # letters, beyond which a name is cut
_MOST_LINES = 3
_PART = re.compile(r"[^_\s,=/.-]*[_\s,=/.-]*")  # of a name, with the sign at which it may be broken


@dataclass(frozen=True)
class Sheet:
    """Format of a still.

    Attributes:
        width: Its width, in inches.
        font: Size of its letters, in pt.
        title: Size of the letters of titles, in pt.
        small: Size of the letters within the axes, in pt.
        marked: True if each colour also has a mark, so that curves are distinguished in print without colours.
    """

    width: float = 6.5
    font: float = _DESIGNED
    title: float = 7.5
    small: float = 6.0
    marked: bool = False

    @property
    def scale(self) -> float:
        """By how much margins and lines of text are larger than on the page of a report."""
        return self.font / _DESIGNED

    @property
    def character(self) -> float:
        """Width of a letter, in inches."""
        return 0.054 * self.scale

    @property
    def line(self) -> float:
        """Height of a line of text, in inches."""
        return 0.135 * self.scale

    def beside(self, wanted: int, count: int, least: float, width: float | None = None) -> int:
        """Return the number of panels side by side.

        Args:
            wanted: How many of them the figure asks for.
            count: How many there are.
            least: Width below which none is read, on the page of a report, in inches.
            width: Room for all of them, in inches; None for the whole width.
        """
        fitting = int((self.width if width is None else width) / (least * self.scale))
        return max(1, min(wanted, count, fitting))


REPORT = Sheet()
"""The text on a page of a report."""


def column(millimetres: float) -> Sheet:
    """Return the column of a journal, all letters of 8 pt, with a mark for each colour."""
    return Sheet(millimetres / _MM, 8.0, 8.0, 8.0, marked=True)


def render_figure(make: Callable[[], Figure], sheet: Sheet, kind: Literal["svg", "pdf"]) -> bytes:
    """Return a drawing, in the style of all stills, as SVG or PDF; the same figure gives the same bytes.

    Letters are outlines in SVG, and an embedded font in PDF.
    """
    dates: dict[str, Any] = {"svg": {"Date": None, "Creator": None},
                             "pdf": {"CreationDate": None, "Creator": None, "Producer": None}}  # fmt: skip
    with mpl.rc_context(style(sheet)), warnings.catch_warnings():
        # Characters that the font lacks become a box, and values without a logarithm leave their axes empty.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        warnings.filterwarnings("ignore", message="Data has no positive values")
        stream = io.BytesIO()
        make().savefig(stream, format=kind, metadata=dates[kind])
    return stream.getvalue()


def style(sheet: Sheet) -> Any:
    """Return the parameters of matplotlib that stills on a sheet are drawn with."""
    return {
        **LINES,
        **dict.fromkeys(_SIZES, sheet.font),
        "axes.titlesize": sheet.title,
        "axes.titlepad": 4,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#e3e6ea",
        "grid.linewidth": 0.5,
        "lines.linewidth": 1.0,
        "lines.markersize": 3.0,
        "path.simplify_threshold": 0.2,
        "pdf.fonttype": 42,
    }


@dataclass(frozen=True)
class NameLayout:
    """Layout of the names of an axis.

    Attributes:
        labels: The names that are shown, of every `step`-th place.
        step: 1 where all places are named.
        turned: True if they are read from below.
        room: Size across the axis, in inches.
    """

    labels: Sequence[str]
    step: int
    turned: bool
    room: float

    def put(self, axis: Axis, count: int) -> None:
        """Name the places of an axis that has this many."""
        # A dollar sign begins a formula in a tick's label, and ticks are labelled again at every drawing.
        labels = [label.replace("$", r"\$") for label in self.labels]
        axis.set_ticks(range(0, count, self.step), labels)
        if self.turned:
            axis.set_tick_params(rotation=90)


def names_below(names: Sequence[str], length: float, sheet: Sheet) -> NameLayout:
    """Return the layout of the names below an axis of a length, in inches.

    Strings are side by side, in up to three lines, or turned, and whole. Of numbers every other one and so on will do.
    """
    texts = [cut(name, _LONGEST) for name in names]
    place = length / max(1, len(texts))
    longest = max(map(len, texts), default=0)
    if (longest + 2) * sheet.character <= place:
        return NameLayout(texts, 1, False, sheet.line)
    if all(map(is_number, texts)):
        step = math.ceil((longest + 2) * sheet.character / place)
        return NameLayout(texts[::step], step, False, sheet.line)
    lines = [_broken(text, int(place / sheet.character) - 1) for text in texts]
    if all(lines):
        return NameLayout(["\n".join(each) for each in lines], 1, False, max(map(len, lines)) * sheet.line)
    step = math.ceil(sheet.line / place)
    return NameLayout(texts[::step], step, True, longest * sheet.character)


def names_beside(names: Sequence[str], length: float, sheet: Sheet) -> NameLayout:
    """Return the layout of the names next to an axis of a length, in inches: in lines where there is room for them."""
    texts = [cut(name, _LONGEST) for name in names]
    step = math.ceil(len(texts) * sheet.line / length) or 1
    room = int(length / sheet.line / max(1, len(texts)))
    lines = [_broken(text, 14, min(room, _MOST_LINES)) or [text] for text in texts[::step]]
    longest = max((len(line) for each in lines for line in each), default=0)
    return NameLayout(["\n".join(each) for each in lines], step, False, longest * sheet.character)


def _broken(text: str, most: int, lines: int = _MOST_LINES) -> list[str]:
    """Return a name in at most `lines` lines of at most `most` letters; nothing if it does not fit."""
    found = [""]
    for part in filter(None, _PART.findall(text)):
        if found[-1] and len((found[-1] + part).rstrip()) > most:
            found.append("")
        found[-1] += part
    found = [line.rstrip() for line in found]
    return found if len(found) <= lines and max(map(len, found)) <= most else []


def literal(label: Text, text: str) -> None:
    """Set a string in which matplotlib finds no markup."""
    label.set_parse_math(False)
    label.set_text(text)


def wrap_text(text: str, characters: float) -> str:
    """Return a string in lines of at most this many characters."""
    return "\n".join(textwrap.wrap(bind_label(plain(text).strip()), max(10, int(characters))))


def cut(text: str, characters: float) -> str:
    """Return a string on one line of at most this many characters, its end cut off where it is longer."""
    text, limit = plain(text).strip(), max(10, int(characters))
    return text if len(text) <= limit else text[: limit - 1] + "…"
