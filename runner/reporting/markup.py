"""Inline markup of report text: literal text, mathematics between dollar signs, links, emphasis and code.

Emphasis, code and addresses are enclosed in private-use characters, which no keyboard types. `marked` inserts these
characters; readers of files reject them in their input.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass

from runner.base.sanitize import plain

_SPAN = re.compile(r"\$\$|\$((?:[^$])+)\$|\$|[^$]+")
_LINK = re.compile(r"§(?P<section>\d+(?:\.\d+)*)|\b(?P<kind>claim|figure|table) (?P<number>\d+(?:\.\d+)*)\b", re.I)
MARKS = {"emphasis": ("\ue000", "\ue001"), "code": ("\ue002", "\ue003")}
"""First and last character around each kind of marked text."""
_ADDRESS_MARKS = ("\ue004", "\ue005", "\ue006")  # before the text, between text and address, behind the address
_MARKED = re.compile(
    "|".join(f"{first}(?P<{kind}>[^\ue000-\ue006]*){last}" for kind, (first, last) in MARKS.items())
    + "|{}(?P<text>[^\ue000-\ue006]*){}(?P<address>[^\ue000-\ue006]*){}".format(*_ADDRESS_MARKS)
)
_WEB = re.compile(r"https?://\S+")


@dataclass(frozen=True)
class Literal:
    """Characters shown as they are.

    Attributes:
        text: The characters.
        math: False, as of all that is no mathematics.
        anchor: Empty, as of all that is no link within the report.
        mark: "emphasis" or "code" where they are set so.
        address: Where a link to a page of the web leads to.
    """

    text: str
    math: bool = False
    anchor: str = ""
    mark: str = ""
    address: str = ""


@dataclass(frozen=True)
class Link:
    """A link to a section, a claim, a figure or a table; shown literally where the report has no such place.

    Attributes:
        text: What is shown.
        anchor: Name of the place that it leads to; see runner/reporting/places.py.
        math: False, as of all that is no mathematics.
        mark: Empty, as of all that is not marked.
        address: Empty, as of all that leads to no page of the web.
    """

    text: str
    anchor: str
    math: bool = False
    mark: str = ""
    address: str = ""


@dataclass(frozen=True)
class Math:
    """Mathematics in Typst's notation, without its dollar signs."""

    text: str
    math: bool = True


Span = Literal | Link | Math


def anchor(number: str) -> str:
    """Return the name of the place of a section, such as "s2-1" for number "2.1"."""
    return "s" + number.replace(".", "-")


def mark_text(text: str, mark: str) -> str:
    """Return a text with the marks of "emphasis" or "code" around it."""
    first, last = MARKS[mark]
    return f"{first}{text}{last}"


def link_text(text: str, address: str) -> str:
    """Return a text as a link to an address of the web; any other address is shown beside it."""
    before, between, behind = _ADDRESS_MARKS
    return f"{before}{text}{between}{address}{behind}"


def literal(text: str) -> str:
    """Return text in which a dollar sign is one, not the begin of mathematics."""
    return text.replace("$", "$$")


def literals(cells: Iterable[str]) -> list[str]:
    """Return texts, such as the cells of a row, in which a dollar sign is one."""
    return [literal(cell) for cell in cells]


def spans(text: str) -> list[Span]:
    """Split a text into literal and mathematical spans, and links.

    `$...$` is mathematics, `$$` a dollar sign, and so is a dollar sign without a partner. `§2.1` is a link to that
    section; "claim 3", "figure 3.5" and "table 2.1" are links to these.

    Args:
        text: Text with inline mathematics as in `document.Text`.

    Returns:
        The spans in reading order; neighbouring literals are one.
    """
    result: list[Span] = []
    for match in _SPAN.finditer(plain(text)):
        if match[1] is not None and match[1].strip():
            result.append(Math(match[1].strip()))
            continue
        shown = "$" if match[0] == "$$" else match[0]
        if result and isinstance(result[-1], Literal):
            shown = result.pop().text + shown
        result.append(Literal(shown))
    return [part for span in result for part in (_marks(span.text) if isinstance(span, Literal) else [span])]


def _marks(text: str) -> list[Span]:
    found: list[Span] = []
    end = 0
    for match in _MARKED.finditer(text):
        found += _links(text[end : match.start()])
        found += _marked_span(match)
        end = match.end()
    return found + _links(text[end:])


def _marked_span(match: re.Match[str]) -> list[Span]:
    for mark in MARKS:
        if match[mark] is not None:
            return [Literal(match[mark], mark=mark)]
    if _WEB.fullmatch(match["address"]):
        return [Literal(match["text"], address=match["address"])]
    return [Literal(f"{match['text']} ({match['address']})")]


def _links(text: str) -> list[Span]:
    found: list[Span] = []
    end = 0
    for match in _LINK.finditer(text):
        found += [Literal(text[end : match.start()]), _link(match)]
        end = match.end()
    return [span for span in [*found, Literal(text[end:])] if span.text]


def _link(match: re.Match[str]) -> Link:
    if match["section"]:
        return Link(f"section {match['section']}", anchor(match["section"]))
    return Link(match[0], f"{match['kind'].lower()}-{match['number'].replace('.', '-')}")
