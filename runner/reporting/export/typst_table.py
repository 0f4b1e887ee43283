"""Typst tables as figures, with their notes as captions."""

from collections.abc import Iterable

from runner.base.sanitize import one_line
from runner.reporting.export.paper_table import PaperTable
from runner.reporting.templating import quote_typst


def typst_table(table: PaperTable) -> str:
    """Return the table as a Typst figure, to be included; its caption is the notes, and comments name its origin."""
    head, *rows = table.lines
    left, right = len(table.heads), len(head) - len(table.heads)
    body = [f"    {_quoted(row)}," for row in rows]
    return "\n".join(
        [
            *(f"// {one_line(source)}" for source in table.sources),
            "#figure(",
            f"  caption: {quote_typst(' '.join(table.notes))},",
            "  table(",
            f"    columns: {len(head)}, align: (left,) * {left} + (right,) * {right}, stroke: none,",
            f"    table.hline(), table.header({_quoted(head)}), table.hline(stroke: 0.5pt),",
            *body,
            "    table.hline(),",
            "  ),",
            ")",
            "",
        ]
    )


def _quoted(texts: Iterable[str]) -> str:
    return ", ".join(map(quote_typst, texts))
