"""Curve colours by name, and readable units of figures and of table columns, throughout a report."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from runner.base.quantities import Shown, choose_unit, fewest_powers, number, smaller_units
from runner.reporting.charts import palette
from runner.reporting.charts.scales import curves_in_readable_units, maps_in_readable_units
from runner.reporting.document import Block, Curves, Document, Maps, Panel, Section, Series, Table
from runner.reporting.outline import blocks

_UNITS = ("m", "s")
_PLAIN = 1e-4  # in a smaller unit a column shows plain decimals down to this: 10.5, 0.0262, 0.0011


def color_series(document: Document) -> Document:
    """Return a report in which all curves of one name have one palette index, unless their figure chose another.

    A name has the index that its meaning or the first figure that chose one gives it, otherwise the first that no
    curve next to it has, in any panel of the report.
    """
    panels = [panel for block in blocks(document) if isinstance(block, Curves) for panel in block.panels]
    found = _by_name(panels)

    def colored(block: Block) -> Block:
        if not isinstance(block, Curves):
            return block
        return replace(block, panels=[replace(panel, series=list(_series(panel, found))) for panel in block.panels])

    return replace(document, sections=_changed(document.sections, colored))


def _by_name(panels: list[Panel]) -> dict[str, int]:
    named = [(panel, series) for panel in panels for series in panel.series if series.name]
    found = {series.name: series.color for _, series in reversed(named) if series.color is not None}
    found |= palette.MEANINGS
    beside: dict[str, list[Series]] = {}
    for panel, series in named:
        beside.setdefault(series.name, []).extend(panel.series)
    for name, others in beside.items():
        taken = {found.get(other.name, other.color) for other in others} | {other.color for other in others}
        found.setdefault(name, next(index for index in range(len(taken) + 1) if index not in taken))
    return found


def _series(panel: Panel, found: Mapping[str, int]) -> Iterator[Series]:
    taken = {series.color for series in panel.series}
    for series in panel.series:
        color = found.get(series.name)
        if series.color is None and color is not None and color not in taken:
            taken.add(color)
            yield replace(series, color=color)
        else:
            yield series


def in_readable_units(document: Document) -> Document:
    """Return a report whose figures and columns "... (m)" and "... (s)" have the unit that fits their numbers."""
    return replace(document, sections=_changed(document.sections, _readable))


def _readable(block: Block) -> Block:
    match block:
        case Table():
            return readable(block)
        case Curves():
            return curves_in_readable_units(block)
        case Maps():
            return maps_in_readable_units(block)
    return block


def readable(table: Table) -> Table:
    """Return a table in which each column of numbers has one unit that fits them.

    The unit is smaller if all of them are below 0.1 m or 0.1 s, or if fewer of them need a power of ten then.
    A column with a string that holds another number stays as it is.
    """
    columns = [_column(head, [row[index] for row in table.rows]) for index, head in enumerate(table.header)]
    rows = [[cells[index] for _, cells in columns] for index in range(len(table.rows))]
    return replace(table, header=[head for head, _ in columns], rows=rows)


def _column(head: str, cells: Sequence[str]) -> tuple[str, Sequence[str]]:
    unit = next((unit for unit in _UNITS if head.endswith(f"({unit})")), None)
    numbers = [cell.value for cell in cells if isinstance(cell, Shown)]
    if unit is None or not any(numbers) or any(_holds_number(cell) for cell in cells):
        return head, cells
    factor, name = fewest_powers(numbers, [choose_unit(max(map(abs, numbers)), unit), *smaller_units(unit)], _PLAIN)
    if name == unit:
        return head, cells
    scaled = [
        number(factor * cell.value, cell.digits, plain=_PLAIN) if isinstance(cell, Shown) else cell for cell in cells
    ]
    return f"{head.removesuffix(f'({unit})')}({name})", scaled


def _holds_number(cell: str) -> bool:
    """Return True if a cell is a string with a number in it, other than a rounded zero."""
    return not isinstance(cell, Shown) and not cell.startswith("0 ") and any(letter.isdigit() for letter in cell)


def _changed(sections: Sequence[Section], change: Callable[[Block], Block]) -> list[Section]:
    """Return sections, and those below them, with each of their blocks changed."""
    return [
        replace(each, blocks=list(map(change, each.blocks)), sections=_changed(each.sections, change))
        for each in sections
    ]
