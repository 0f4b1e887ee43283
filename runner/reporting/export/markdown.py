"""Markdown tables in GitHub format."""

import re

from runner.base.quantities import SUPERSCRIPT, unit_text
from runner.base.sanitize import plain
from runner.reporting.export.columns import Cell, Column, Unit
from runner.reporting.export.paper_table import Label, PaperTable

_MEANT = re.compile(r"([\\`*{}\[\]#|~$!])|(?<![^\W_])(_)|(_)(?![^\W_])")  # an underscore within a word is itself


def markdown(table: PaperTable) -> str:
    """Return the table as Markdown, its notes below it."""
    counts = table.counts
    heads = [*map(escape_markdown, table.heads), *map(_head, table.columns), *(["n"] if counts else [])]
    marks = ["---"] * len(table.heads) + ["---:"] * (len(heads) - len(table.heads))
    lines = [heads, marks]
    for row, labels in enumerate(table.labels):
        numbers = [_numbers(column.cells[row]) for column in table.columns]
        lines.append([*map(_label, labels), *numbers, *([counts[row]] if counts else [])])
    below = "  \n".join(map(escape_markdown, [" ".join(table.notes), *table.sources]))
    return "\n".join(["| " + " | ".join(line) + " |" for line in lines]) + f"\n\n{below}\n"


def _head(column: Column) -> str:
    unit = unit_name(column.unit)
    untitled = "median [95 % interval]" if column.has_intervals else "median"
    return escape_markdown(f"{column.title} ({unit})" if unit else column.title or untitled)


def _label(label: Label) -> str:
    return escape_markdown(unit_name(label) if isinstance(label, Unit) else label)


def _numbers(cell: Cell) -> str:
    return f"{cell.median} \\[{cell.low}, {cell.high}\\]" if cell.low else cell.median


def unit_name(unit: Unit) -> str:
    """Return a unit as it is read, such as "10⁻⁶ N m"; nothing for 1."""
    power = f"10{str(unit.power).translate(SUPERSCRIPT)}" if unit.power else ""
    return f"{power} {unit_text(str(unit))}".strip()


def escape_markdown(text: str) -> str:
    """Return a text of which no character means anything to Markdown."""
    safe = plain(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return _MEANT.sub(lambda found: f"\\{found[0]}", safe)
