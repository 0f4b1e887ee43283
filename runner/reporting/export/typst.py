"""Tables for papers as Typst figures."""

from collections.abc import Sequence

from runner.base.sanitize import one_line
from runner.reporting.export.columns import PaperColumn, lay_out
from runner.reporting.export.fitting import fit
from runner.reporting.table import Table
from runner.reporting.templating import quote_typst


def write_typst(table: Table, caption: str, sources: Sequence[str], width: float | None = None) -> str:
    """Return a table as a Typst figure, to be included, with comments on its origin.

    Args:
        table: The table.
        caption: Its caption.
        sources: Where it comes from, a comment each.
        width: Width that it has to fit, in mm; None for the letters of the page, without a limit.

    Raises:
        RunnerError: If it does not fit the width.
    """
    columns = lay_out(table)
    titles: Sequence[Sequence[str]] = [[each.head] for each in columns]
    fitted, letters = "", 0.0
    if width is not None:
        titles, room, letters = fit(columns, width, lambda column: [_cells(column)], at_edges=True)
        fitted = f" inset: (x: {room:g}pt, y: 3pt),"
    head = ", ".join(quote_typst("\n".join(lines)).replace("\n", "\\n") for lines in titles)
    rows = [", ".join(map(quote_typst, cells)) for cells in zip(*map(_cells, columns), strict=True)]
    sides = ", ".join("right" if each.kind == "number" else "left" for each in columns)
    lines = [
        "table(",
        f"  columns: {len(columns)}, align: ({sides}), stroke: none,{fitted}",
        f"  table.hline(), table.header({head}), table.hline(stroke: 0.5pt),",
        *(f"  {row}," for row in rows),
        "  table.hline(),",
        ")",
    ]
    if width is not None:
        lines = [f"text({letters:g}pt, {lines[0]}", *lines[1:-1], "))"]
    return "\n".join(
        [
            *(f"// {one_line(source)}" for source in sources),
            "#figure(",
            f"  caption: {quote_typst(caption)},",
            *(f"  {line}" for line in lines[:-1]),
            f"  {lines[-1]},",
            ")",
            "",
        ]
    )


def _cells(column: PaperColumn) -> list[str]:
    """Return the cells of a column, whose spaces break no line."""
    return [cell.with_interval("[{}, {}]").replace(" ", "\u00a0") for cell in column.cells]
