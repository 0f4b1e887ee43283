"""Widths of strings by the metrics of a font, and strings broken into lines that fit."""

from collections.abc import Callable
from functools import lru_cache

from matplotlib import cbook
from matplotlib.ft2font import FT2Font

from runner.base.sanitize import plain

SANS, COMPUTER_MODERN = "DejaVuSans.ttf", "cmr10.ttf"
"""Fonts of matplotlib: that of figures, and that of LaTeX."""

_SIZE = 100.0  # pt, at which widths are measured


def text_width(text: str, size: float, font: str = SANS) -> float:
    """Return the width of a string in letters of a size, both in pt; a letter that the font lacks is as wide as m."""
    widths = _widths(font)
    return size * sum(widths(letter) for letter in text)


@lru_cache(maxsize=8)
def _widths(font: str) -> Callable[[str], float]:
    """Return the function that gives the width of a letter, relative to the size."""
    face = FT2Font(str(cbook._get_data_path("fonts", "ttf", font)))
    face.set_size(_SIZE, 72)
    known = face.get_charmap()

    @lru_cache(maxsize=1024)
    def width(letter: str) -> float:
        letter = " " if letter == "\u00a0" else letter
        code = ord(letter) if ord(letter) in known else ord("m")
        return face.load_char(code).linearHoriAdvance / 65536.0 / _SIZE

    return width


def wrap(text: str, width: float, size: float, font: str = SANS) -> list[str]:
    """Return a string in lines of at most a width, in pt, broken at spaces; a longer word has its own line."""
    lines: list[str] = []
    for word in plain(text).split(" "):
        if lines and text_width(f"{lines[-1]} {word}", size, font) <= width:
            lines[-1] += f" {word}"
        elif word:
            lines.append(word)
    return lines or [""]
