"""Text of a report taken apart: what is shown literally, mathematics between dollar signs, links to sections."""

import re
import unicodedata
from dataclasses import dataclass

_OVERRIDES = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
_SPAN = re.compile(r"\$\$|\$((?:[^$])+)\$|\$|[^$]+")
_LINK = re.compile(r"§(\d+(?:\.\d+)*)")
_SPACE = re.compile(r"\s+")


@dataclass(frozen=True)
class Literal:
    """Characters shown as they are."""

    text: str
    math: bool = False
    anchor: str = ""


@dataclass(frozen=True)
class Link:
    """A link to a section of the report, by its number; shown literally where there is no such section."""

    number: str
    math: bool = False

    @property
    def text(self) -> str:
        """What is shown."""
        return f"section {self.number}"

    @property
    def anchor(self) -> str:
        """Name of the place that the link leads to."""
        return anchor(self.number)


@dataclass(frozen=True)
class Math:
    """Mathematics in Typst's notation, without its dollar signs."""

    text: str
    math: bool = True


Span = Literal | Link | Math


def anchor(number: str) -> str:
    """Return the name of the place of a section, such as "s2-1" for number "2.1"."""
    return "s" + number.replace(".", "-")


def plain(text: str) -> str:
    """Return the text on one line, without the characters that no XML, PDF or UTF-8 file can hold.

    Control characters, lone surrogates, noncharacters and direction overrides become U+FFFD: they could hide or
    reorder what stands beside them.
    """
    if text.isprintable() and "  " not in text:
        return text
    return "".join(map(_visible, _SPACE.sub(" ", text)))


def spans(text: str) -> list[Span]:
    """Split a text into literal and mathematical spans, and links.

    `$...$` is mathematics, `$$` a dollar sign, and so is a dollar sign without a partner. `§2.1` is a link to that
    section.

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
        literal = "$" if match[0] == "$$" else match[0]
        if result and isinstance(result[-1], Literal):
            literal = result.pop().text + literal
        result.append(Literal(literal))
    return [part for span in result for part in (_links(span.text) if isinstance(span, Literal) else [span])]


def _links(text: str) -> list[Span]:
    parts = _LINK.split(text)  # literals at even places, section numbers at odd ones
    found: list[Span] = [Link(part) if index % 2 else Literal(part) for index, part in enumerate(parts)]
    return [span for span in found if span.text]


def _visible(character: str) -> str:
    code = ord(character)
    control = unicodedata.category(character) in ("Cc", "Cs") or unicodedata.bidirectional(character) in _OVERRIDES
    return "\ufffd" if control or code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF else character
