"""Table columns of lengths and times in readable units, such as mm instead of powers of ten."""

from collections.abc import Sequence
from dataclasses import replace

from runner.base.quantities import Shown, choose_unit, fewest_powers, number, smaller_units
from runner.reporting.document import Block, Document, Section, Table

_UNITS = ("m", "s")
_PLAIN = 1e-4  # in a smaller unit a column shows plain decimals down to this: 10.5, 0.0262, 0.0011


def in_readable_units(document: Document) -> Document:
    """Return a report whose columns of lengths and times, "... (m)" and "... (s)", have the unit that fits them."""
    return replace(document, sections=[_section(section) for section in document.sections])


def readable(table: Table) -> Table:
    """Return a table in which each column of numbers has one unit that fits them.

    Where all of them lie below 0.1 m or 0.1 s the unit is smaller, and where fewer of them need a power of ten then.
    A column with a text that holds a number of its own stays as it is.
    """
    columns = [_column(head, [row[index] for row in table.rows]) for index, head in enumerate(table.header)]
    rows = [[cells[index] for _, cells in columns] for index in range(len(table.rows))]
    return replace(table, header=[head for head, _ in columns], rows=rows)


def _section(section: Section) -> Section:
    blocks: list[Block] = [readable(block) if isinstance(block, Table) else block for block in section.blocks]
    return replace(section, blocks=blocks, sections=[_section(each) for each in section.sections])


def _column(head: str, cells: Sequence[str]) -> tuple[str, Sequence[str]]:
    unit = next((unit for unit in _UNITS if head.endswith(f"({unit})")), None)
    numbers = [cell.value for cell in cells if isinstance(cell, Shown)]
    if unit is None or not any(numbers) or any(_holds_number(cell) for cell in cells):
        return head, cells
    factor, name = fewest_powers(numbers, [choose_unit(max(map(abs, numbers)), unit), *smaller_units(unit)], _PLAIN)
    if name == unit:
        return head, cells
    return f"{head.removesuffix(f'({unit})')}({name})", [_scaled(cell, factor) for cell in cells]


def _holds_number(cell: str) -> bool:
    """Tell whether a cell is a text with a number in it, other than a rounded zero, whose unit nobody could change."""
    return not isinstance(cell, Shown) and not cell.startswith("0 ") and any(letter.isdigit() for letter in cell)


def _scaled(cell: str, factor: float) -> str:
    return number(factor * cell.value, cell.digits, plain=_PLAIN) if isinstance(cell, Shown) else cell
