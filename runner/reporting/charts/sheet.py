"""Page width, font size and file output of stills."""

import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.figure import Figure

_MM = 25.4  # in an inch
_DESIGNED = 7.0  # pt, for which the measures below are made


@dataclass(frozen=True)
class Sheet:
    """What a still is drawn for.

    Attributes:
        width: Its width, in inches.
        font: Size of its letters, in pt.
        title: Size of the letters of titles, in pt.
        small: Size of the letters within the axes, in pt.
    """

    width: float = 6.5
    font: float = _DESIGNED
    title: float = 7.5
    small: float = 6.0

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
        """Return how many panels stand beside each other.

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
    """Return the column of a journal, all letters of 8 pt."""
    return Sheet(millimetres / _MM, 8.0, 8.0, 8.0)


def render_figure(make: Callable[[], Figure], sheet: Sheet, kind: Literal["svg", "pdf"]) -> bytes:
    """Return what is drawn, in the style of all stills, as SVG or PDF; the same figure gives the same bytes.

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
        "font.size": sheet.font,
        "axes.titlesize": sheet.title,
        "axes.labelsize": sheet.font,
        "xtick.labelsize": sheet.font,
        "ytick.labelsize": sheet.font,
        "legend.fontsize": sheet.font,
        "axes.titlepad": 4,
        "axes.linewidth": 0.5,
        "axes.edgecolor": "#555b66",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#e3e6ea",
        "grid.linewidth": 0.5,
        "xtick.major.width": 0.5,
        "ytick.major.width": 0.5,
        "lines.linewidth": 1.0,
        "lines.markersize": 3.0,
        "path.simplify_threshold": 0.2,
        "pdf.fonttype": 42,
        "svg.fonttype": "path",
        "svg.hashsalt": "runner",
    }
