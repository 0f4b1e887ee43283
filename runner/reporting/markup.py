"""Inline markup of report text: literal text, mathematics between dollar signs, links, emphasis and code.

Emphasis, code and addresses are enclosed in private-use characters, which no keyboard types. `marked` inserts these
characters; readers of files reject them in their input.
"""

import re
from collections.abc import Callable
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
class Span:
    """A part of a string that is shown in one way; literally, unless one of the following is set.

    Attributes:
        text: The characters; of mathematics, in Typst's notation without its dollar signs.
        math: True if it is mathematics.
        anchor: Name of the section, claim, figure or table that it links to, as in outline.py. It is shown
            literally if the report has no such place.
        mark: "emphasis" or "code" if it is set so.
        address: Web address that it links to.
    """

    text: str
    math: bool = False
    anchor: str = ""
    mark: str = ""
    address: str = ""


def anchor(number: str) -> str:
    """Return the name of the place of a section, such as "s2-1" for number "2.1"."""
    return "s" + number.replace(".", "-")


def mark_text(text: str, mark: str) -> str:
    """Return a string with the marks of "emphasis" or "code" around it."""
    first, last = MARKS[mark]
    return f"{first}{text}{last}"


def link_text(text: str, address: str) -> str:
    """Return a string as a link to an address of the web; any other address is shown after it."""
    before, between, behind = _ADDRESS_MARKS
    return f"{before}{text}{between}{address}{behind}"


def literal(text: str) -> str:
    """Return text in which a dollar sign is one, not the begin of mathematics."""
    return text.replace("$", "$$")


def spans(text: str) -> list[Span]:
    """Split a string into literal and mathematical spans, and links.

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
            result.append(Span(match[1].strip(), math=True))
            continue
        shown = "$" if match[0] == "$$" else match[0]
        if result and not result[-1].math:
            shown = result.pop().text + shown
        result.append(Span(shown))
    return [part for span in result for part in ([span] if span.math else _marks(span.text))]


def without_marks(text: str) -> str:
    """Return a string as plain text: code between backquotes, addresses in brackets, mathematics between dollars."""

    def show(span: Span) -> str:
        shown = f"${span.text}$" if span.math else f"`{span.text}`" if span.mark == "code" else span.text
        return f"{shown} ({span.address})" if span.address else shown

    return "".join(map(show, spans(text)))


def _marks(text: str) -> list[Span]:
    return _split(_MARKED, text, _marked_span, _links)


def _links(text: str) -> list[Span]:
    return _split(_LINK, text, _link, lambda rest: [Span(rest)] if rest else [])


def _split(
    pattern: re.Pattern[str], text: str, show: Callable[[re.Match[str]], Span], others: Callable[[str], list[Span]]
) -> list[Span]:
    """Return the spans of what matches, and of the strings between, in reading order."""
    found: list[Span] = []
    end = 0
    for match in pattern.finditer(text):
        found += [*others(text[end : match.start()]), show(match)]
        end = match.end()
    return [*found, *others(text[end:])]


def _marked_span(match: re.Match[str]) -> Span:
    for mark in MARKS:
        if match[mark] is not None:
            return Span(match[mark], mark=mark)
    if _WEB.fullmatch(match["address"]):
        return Span(match["text"], address=match["address"])
    return Span(f"{match['text']} ({match['address']})")


def _link(match: re.Match[str]) -> Span:
    if match["section"]:
        return Span(f"section {match['section']}", anchor=anchor(match["section"]))
    return Span(match[0], anchor=f"{match['kind'].lower()}-{match['number'].replace('.', '-')}")
