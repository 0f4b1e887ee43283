"""Tick labels of a categorical axis: complete names, broken into lines or rotated to fit."""

import math
import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axis import Axis
from matplotlib.text import Text

from runner.base.sanitize import plain
from runner.reporting.charts.sheet import Sheet

_LONGEST = 28  # letters, beyond which a name is cut
_MOST_LINES = 3
_PART = re.compile(r"[^_\s,=/.-]*[_\s,=/.-]*")  # of a name, with the sign at which it may be broken


@dataclass(frozen=True)
class Names:
    """How an axis is named.

    Attributes:
        labels: The names that are shown, of every `step`-th place.
        step: 1 where all places are named.
        turned: Whether they are read from below.
        room: What they take across the axis, in inches.
    """

    labels: Sequence[str]
    step: int
    turned: bool
    room: float

    def put(self, axis: Axis, count: int) -> None:
        """Name the places of an axis that has so many."""
        # A dollar sign begins a formula in a tick's label, and ticks are labelled anew at every drawing.
        labels = [label.replace("$", r"\$") for label in self.labels]
        axis.set_ticks(range(0, count, self.step), labels)
        if self.turned:
            axis.set_tick_params(rotation=90)


def names_below(names: Sequence[str], length: float, sheet: Sheet) -> Names:
    """Return how the names below an axis of a length stand, in inches.

    Texts stand side by side, in up to three lines, or turned, and whole. Of numbers every other one and so on will do.
    """
    texts = [cut(name, _LONGEST) for name in names]
    place = length / max(1, len(texts))
    longest = max(map(len, texts), default=0)
    if (longest + 2) * sheet.character <= place:
        return Names(texts, 1, False, sheet.line)
    if all(map(_is_number, texts)):
        step = math.ceil((longest + 2) * sheet.character / place)
        return Names(texts[::step], step, False, sheet.line)
    lines = [_broken(text, int(place / sheet.character) - 1) for text in texts]
    if all(lines):
        return Names(["\n".join(each) for each in lines], 1, False, max(map(len, lines)) * sheet.line)
    step = math.ceil(sheet.line / place)
    return Names(texts[::step], step, True, longest * sheet.character)


def names_beside(names: Sequence[str], length: float, sheet: Sheet) -> Names:
    """Return how the names beside an axis of a length stand, in inches: in lines where there is room for them."""
    texts = [cut(name, _LONGEST) for name in names]
    step = math.ceil(len(texts) * sheet.line / length) or 1
    room = int(length / sheet.line / max(1, len(texts)))
    lines = [_broken(text, 14, min(room, _MOST_LINES)) or [text] for text in texts[::step]]
    longest = max((len(line) for each in lines for line in each), default=0)
    return Names(["\n".join(each) for each in lines], step, False, longest * sheet.character)


def _broken(text: str, most: int, lines: int = _MOST_LINES) -> list[str]:
    """Return a name in so few lines of at most so many letters; nothing where that cannot be."""
    found = [""]
    for part in filter(None, _PART.findall(text)):
        if found[-1] and len((found[-1] + part).rstrip()) > most:
            found.append("")
        found[-1] += part
    found = [line.rstrip() for line in found]
    return found if len(found) <= lines and max(map(len, found)) <= most else []


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def literal(label: Text, text: str) -> None:
    """Set a text of which no character means anything to matplotlib."""
    label.set_parse_math(False)
    label.set_text(text)


def wrap_text(text: str, characters: float) -> str:
    """Return a text in lines of so many characters."""
    return "\n".join(textwrap.wrap(plain(text).strip(), max(10, int(characters))))


def cut(text: str, characters: float) -> str:
    """Return a text on one line of so many characters, its end cut off where it is longer."""
    text, limit = plain(text).strip(), max(10, int(characters))
    return text if len(text) <= limit else text[: limit - 1] + "…"
