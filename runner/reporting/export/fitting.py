"""Tables for papers within a width: titles in several lines, and the room between columns."""

from collections.abc import Callable, Sequence
from itertools import product
from typing import NamedTuple

from runner.base.errors import RunnerError
from runner.reporting.charts.letters import COMPUTER_MODERN, text_width, wrap
from runner.reporting.export.columns import PaperColumn

_LETTERS = (8.0, 7.5, 7.0)  # pt, the largest first: journals ask for 7 or more
_ROOMS = (5.0, 4.5, 4.0, 3.5, 3.0, 2.5, 2.0)  # pt, on each side of a column
_SMALL = 1.07  # Computer Modern of 8 pt over its 10 pt letters at that size
_MM = 72.0 / 25.4  # pt
Parts = Callable[[PaperColumn], Sequence[Sequence[str]]]


class Fitted(NamedTuple):
    """Layout of a table within a width.

    Attributes:
        titles: Title of each column in lines.
        room: Room on each side of a column, in pt.
        letters: Size of the letters, in pt.
    """

    titles: Sequence[Sequence[str]]
    room: float
    letters: float


def fit(columns: Sequence[PaperColumn], width: float, parts: Parts, at_edges: bool) -> Fitted:
    """Return the layout with the largest letters, then with titles in one line, then with the most room.

    Args:
        columns: The columns.
        width: Width of the table, in mm.
        parts: The strings of each part of a column that are below each other, such as numbers and intervals.
        at_edges: True if the outer columns have their room at the edges, too.

    Raises:
        RunnerError: If they do not fit; names the width that they need.
    """
    for letters, is_whole, room in product(_LETTERS, (True, False), _ROOMS):
        widths = [_width(column, parts(column), room, letters, is_whole) for column in columns]
        needed = sum(widths) + 2.0 * room * (len(columns) - (0 if at_edges else 1))
        if needed <= width * _MM:
            titles = [
                wrap(column.head, own / _SMALL + 1e-6, letters, COMPUTER_MODERN)
                for column, own in zip(columns, widths, strict=True)
            ]
            return Fitted(titles, room, letters)
    raise RunnerError(
        f"--width: the table needs {needed / _MM + 0.5:.0f} mm, and {width:g} mm are allowed. Take a larger width, or "
        "fewer metrics by --metrics A,B."
    )


def _width(column: PaperColumn, parts: Sequence[Sequence[str]], room: float, letters: float, is_whole: bool) -> float:
    """Return the width of a column: that of its parts, or of its title, whole or only its longest word."""

    def measured(text: str) -> float:
        return _SMALL * text_width(text, letters, COMPUTER_MODERN)

    content = sum(max(map(measured, part), default=0.0) for part in parts) + 2.0 * room * (len(parts) - 1)
    return max(content, *map(measured, [column.head] if is_whole else column.head.split(" ")))
