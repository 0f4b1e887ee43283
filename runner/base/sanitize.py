"""Sanitized external text for display: one line, no control characters, limited length."""

import csv
import io
import re
import unicodedata
from collections.abc import Iterable, Sequence
from functools import lru_cache

VALUE = 200
"""Largest length of a quoted value, in characters."""
LINE = 2000
"""Largest length of a line of a message, in characters."""
LINES = 50
"""Largest number of lines of a message."""
_OVERRIDES = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
_SPACE = re.compile(r"[^\S\u00a0]+")  # not a no-break space, as in a unit


def escaped(text: str) -> str:
    r"""Return text on one line, with line breaks, terminal escapes and invisible characters escaped as \n or \x1b."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def one_line(text: str, longest: int = LINE) -> str:
    """Return escaped text; if it is longer than `longest`, it is cut and ends with its original length."""
    shown = escaped(text[: longest + 1])
    if len(shown) <= longest:
        return shown
    end = f"... ({len(text)} characters)"
    return shown[: longest - len(end)] + end


def lines(text: str) -> str:
    """Return text with each line sanitized; line breaks stay, and lines beyond the first fifty are cut."""
    found = text.split("\n")
    if len(found) > LINES:
        found = [*found[: LINES - 1], f"and {len(found) - LINES + 1} more lines"]
    return "\n".join(map(one_line, found))


def quoted(value: object) -> str:
    """Return the quoted value for a message, at most one line."""
    try:
        return one_line(repr(value), VALUE)
    except (ValueError, RecursionError):  # Python does not print integers with more than about 4,300 digits
        return f"a value too large to show ({type(value).__name__})"


def few(names: Sequence[str], most: int = 8, separator: str = ", ") -> str:
    """Return names as a list, of many the first ones and the number of the others."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return separator.join(names[:most]) + more


def table_cell(text: str) -> str:
    """Return text as a cell of a CSV table that spreadsheets do not read as a formula; a number does not change."""
    try:
        float(text)
    except ValueError:
        return f"'{escaped(text)}" if text.startswith(("=", "+", "-", "@", "\t", "\r", "\n")) else escaped(text)
    return text


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Return rows as comma-separated values, each cell as by `table_cell`; NaN is an empty cell."""
    stream = io.StringIO(newline="")
    cells = ([table_cell("" if value != value else str(value)) for value in row] for row in rows)
    csv.writer(stream, lineterminator="\n").writerows(cells)
    return stream.getvalue()


def plain(text: str) -> str:
    """Return the text on one line, without characters that XML, PDF or UTF-8 files cannot contain.

    Control characters, lone surrogates, noncharacters and direction overrides become U+FFFD, because they could hide or
    reorder other text.
    """
    if text.isprintable() and "  " not in text:
        return text
    return "".join(map(_visible, _SPACE.sub(" ", text)))


@lru_cache(maxsize=4096)
def _visible(character: str) -> str:
    code = ord(character)
    control = unicodedata.category(character) in ("Cc", "Cs") or unicodedata.bidirectional(character) in _OVERRIDES
    return "\ufffd" if control or code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF else character
