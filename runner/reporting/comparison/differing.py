"""Tables of the config and provenance differences between two sweeps."""

from runner.base.quantities import label_with_unit
from runner.config.compose.key_units import key_unit
from runner.reporting.comparison.beyond import Value
from runner.reporting.comparison.sweeps import SweepComparison
from runner.reporting.document import Block, Table
from runner.reporting.markup import literals
from runner.sweeps.differing import UNITS

_MOST_ROWS, _LONGEST = 40, 60


def tables(found: SweepComparison) -> list[Block]:
    """Return the resolved values that differ, and what made the runs where that differs."""
    a, b = found.a.name, found.b.name
    values = [*found.beyond.options, *found.beyond.values]
    blocks: list[Block] = []
    if values:
        left = len(values) - _MOST_ROWS
        more = f" {left} more differ." if left > 0 else ""
        caption = f"All resolved values that differ in the cells that both have.{more}"
        blocks.append(Table(caption, ["key", a, b, "at"], [_row(value) for value in values[:_MOST_ROWS]]))
    if found.beyond.provenance:
        rows = [literals([value.key, value.a, value.b]) for value in found.beyond.provenance]
        blocks.append(Table("They were made by different versions.", ["made by", a, b], rows))
    return blocks


def _row(value: Value) -> list[str]:
    label = label_with_unit(value.key, UNITS.get(value.key) or key_unit(value.key))
    return literals([label, _short(value.a), _short(value.b), value.cells or "all cells"])


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
