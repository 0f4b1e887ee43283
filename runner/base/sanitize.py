"""Sanitized external text for display: one line, no control characters, limited length; aligned columns."""

import re
import unicodedata
from collections.abc import Sequence

VALUE = 200
"""Largest length of a quoted value, in characters."""
LINE = 2000
"""Largest length of a line of a message, in characters."""
LINES = 50
"""Largest number of lines of a message."""
_NAMES = 8
_OVERRIDES = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
_SPACE = re.compile(r"\s+")


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


def few(names: Sequence[str]) -> str:
    """Return names as a list, with at most the first eight."""
    more = f" and {len(names) - _NAMES} more" if len(names) > _NAMES else ""
    return ", ".join(names[:_NAMES]) + more


def align_columns(rows: Sequence[Sequence[str]], indent: str = "  ") -> str:
    """Return rows of equal length as lines with aligned columns; the cells are sanitized for a terminal."""
    rows = [[one_line(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(f"{indent}{line}".rstrip() for line in lines)


def table_cell(text: str) -> str:
    """Return text as a cell of a CSV table that spreadsheets do not read as a formula; a number does not change."""
    try:
        float(text)
    except ValueError:
        return f"'{escaped(text)}" if text.startswith(("=", "+", "-", "@", "\t", "\r", "\n")) else escaped(text)
    return text


def plain(text: str) -> str:
    """Return the text on one line, without characters that XML, PDF or UTF-8 files cannot contain.

    Control characters, lone surrogates, noncharacters and direction overrides become U+FFFD, because they could hide or
    reorder other text.
    """
    if text.isprintable() and "  " not in text:
        return text
    return "".join(map(_visible, _SPACE.sub(" ", text)))


def _visible(character: str) -> str:
    code = ord(character)
    control = unicodedata.category(character) in ("Cc", "Cs") or unicodedata.bidirectional(character) in _OVERRIDES
    return "\ufffd" if control or code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF else character
