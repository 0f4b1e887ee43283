"""HTML for notebooks, with every external string escaped."""

import base64
import html
from collections.abc import Iterable, Sequence

from runner.base.sanitize import plain


def text(value: object) -> str:
    """Return a value as escaped HTML, which a browser shows literally."""
    return html.escape(plain(str(value)))


def heading(words: str, remark: str = "") -> str:
    """Return a line in bold, followed by a remark."""
    return f"<p><strong>{text(words)}</strong>{f' {text(remark)}' if remark else ''}</p>"


def line(words: str) -> str:
    """Return a paragraph; an empty string for an empty line."""
    return f"<p>{text(words)}</p>" if words else ""


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table."""
    head = "".join(f'<th style="text-align:left">{text(name)}</th>' for name in header)
    body = "".join(
        "<tr>" + "".join(f'<td style="text-align:left">{text(cell)}</td>' for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def listed(title: str, items: Sequence[str]) -> str:
    """Return a list under a title; an empty string for an empty list."""
    points = "".join(f"<li>{text(item)}</li>" for item in items)
    return f"<p>{text(title)}</p><ul>{points}</ul>" if items else ""


def code(words: object) -> str:
    """Return a path or a command."""
    return f"<p><code>{text(words)}</code></p>"


def picture(svg: str, words: str) -> str:
    """Return an SVG as an image element: its scripts do not run, and its names do not clash with others on the page."""
    content = base64.b64encode(svg.encode()).decode("ascii")
    return f'<img alt="{text(words)}" style="max-width:40em;width:100%" src="data:image/svg+xml;base64,{content}">'
