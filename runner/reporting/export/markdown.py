"""Markdown tables in GitHub format."""

import re

from runner.base.sanitize import plain
from runner.reporting.export.paper_table import PaperTable

_MEANT = re.compile(r"([\\`*{}\[\]#|~$!])|(?<![^\W_])(_)|(_)(?![^\W_])")  # an underscore within a word is itself


def markdown(table: PaperTable) -> str:
    """Return the table as Markdown, its notes below it."""
    head, *rows = [[escape_markdown(text) for text in line] for line in table.lines]
    marks = ["---"] * len(table.heads) + ["---:"] * (len(head) - len(table.heads))
    below = "  \n".join(map(escape_markdown, [" ".join(table.notes), *table.sources]))
    return "\n".join(["| " + " | ".join(line) + " |" for line in [head, marks, *rows]]) + f"\n\n{below}\n"


def escape_markdown(text: str) -> str:
    """Return a string in which Markdown finds no markup."""
    safe = plain(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return _MEANT.sub(lambda found: f"\\{found[0]}", safe)
