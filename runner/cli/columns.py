"""Plain-text tables for a terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from runner.base.sanitize import one_line

if TYPE_CHECKING:
    from runner.reporting.answers import Answer

COMPARED = ("interval", "n", "effect", "p")
"""Columns of what `answer_cells` returns, between the difference and the word."""


def align_columns(rows: Sequence[Sequence[str]], indent: str = "  ") -> str:
    """Return rows of equal length as lines with aligned columns; the cells are sanitized for a terminal."""
    rows = [[one_line(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(f"{indent}{line}".rstrip() for line in lines)


def number(value: float | None) -> str:
    """Return a number with five digits, or "-" if there is none."""
    return "-" if value is None else f"{value:.5g}"


def answer_cells(answer: "Answer") -> list[str]:
    """Return the difference, the columns in COMPARED, and the conclusion of a comparison, in SI units."""
    found, interval = answer.comparison, answer.interval
    return [
        number(found.difference),
        "-" if interval is None else " to ".join(map(number, interval)),
        str(found.n),
        f"{found.effect:.2f}",
        "-" if answer.p_value is None else f"{answer.p_value:.2g}",
        answer.word,
    ]
