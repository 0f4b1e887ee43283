"""Plain text tables for a terminal."""

from collections.abc import Sequence

from runner.texts import one_line


def aligned(rows: Sequence[Sequence[str]], indent: str = "  ") -> str:
    """Return rows of equal length as lines with aligned columns; cells are made safe to print."""
    rows = [[one_line(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows)
    return "\n".join(f"{indent}{line}".rstrip() for line in lines)


def number(value: float | None) -> str:
    """Return a number with five digits, "-" where there is none."""
    return "-" if value is None else f"{value:.5g}"
