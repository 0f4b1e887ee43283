"""Blocks from Markdown headings, paragraphs and lists, parsed by markdown-it."""

import dataclasses
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.token import Token
from mdit_py_plugins.dollarmath import dollarmath_plugin

from runner.base.quantities import ROUNDING, in_one_unit, number, smaller_units
from runner.papers.study.measured import Measured
from runner.papers.study.prose.expressions import PLACEHOLDER, PRIVATE, ChapterValues, ProseError
from runner.reporting.document import Items, ReportBlock, Section, Text
from runner.reporting.markup import link_text, literal, mark_text

_SENTENCES = re.compile(r"(?<=[.;?!])\s")
_NAMES = {
    "blockquote_open": "quotations",
    "ordered_list_open": "numbered lists",
    "fence": "blocks of code",
    "code_block": "blocks of code (a line begins with four spaces)",
    "hr": "rules",
    "math_block": "formulas between two dollar signs (write {{ formula(typst) }})",
    "image": "images",
    "hardbreak": "line breaks",
    "strong_open": "strong emphasis (write *so*)",
}


@dataclass(frozen=True)
class Heading:
    """A heading.

    Attributes:
        level: 1 for the chapter's title, 2 for a section of it.
        title: Its text.
        line: Its line, counted from 1.
    """

    level: int
    title: str
    line: int


Piece = Heading | ReportBlock | Section
"""Element of a chapter."""


class Paragraphs:
    """Reads pieces of Markdown.

    Args:
        file: Name of the chapter's file.
        values: The values of its expressions.
    """

    def __init__(self, file: str, values: ChapterValues) -> None:
        self._file, self._values = file, values
        self._parser = MarkdownIt("commonmark", {"html": False}).use(dollarmath_plugin, allow_space=False)

    def blocks(self, text: str, first_line: int) -> Iterator[Piece]:
        """Yield the headings and blocks of a piece that begins on a line of the text without expressions.

        Raises:
            ProseError: for what a report has no block for.
        """
        tokens = iter(self._parser.parse(text))
        for token in tokens:
            line = self._values.line_of(first_line + (token.map[0] if token.map else 0))
            if token.type == "heading_open":
                yield Heading(int(token.tag[1]), self.title(next(tokens).content, line), line)
                next(tokens)
            elif token.type == "paragraph_open":
                yield from self._paragraph(next(tokens), line)
                next(tokens)
            elif token.type == "bullet_list_open":
                yield Items(tuple(self._items(tokens, line)))
            else:
                raise self._refused(token, line)

    def title(self, text: str, line: int) -> str:
        """Return the title of a section or a box, which is plain text.

        Raises:
            ProseError: if it has mathematics, emphasis, code or a link.
        """
        parts: list[str] = []
        for child in self._parser.parseInline(text)[0].children or ():
            if child.type != "text":
                raise ProseError(self._file, line, f"'{text}': a title is plain text; write the rest in the paragraph")
            parts.append(literal(child.content))
        shown = "".join(parts)
        return filled(shown, self._values, self._file, values_shown(shown, self._values)).replace("$$", "$")

    def _paragraph(self, inline: Token, line: int) -> Iterator[Piece]:
        alone = PLACEHOLDER.sub("", inline.content).strip() == ""
        found = [self._values.found[int(number)][0] for number in PLACEHOLDER.findall(inline.content)]
        if alone and found and all(_is_block(value) for value in found):
            for value in found:
                yield from value if isinstance(value, Sequence) else (value,)
        else:
            yield Text(self._inline(inline, line))

    def _items(self, tokens: Iterator[Token], line: int) -> Iterator[str]:
        for token in tokens:
            if token.type == "bullet_list_close":
                return
            if token.type == "inline":
                yield self._inline(token, line)
            elif token.type not in ("list_item_open", "list_item_close", "paragraph_open", "paragraph_close"):
                raise self._refused(token, line)

    def _inline(self, inline: Token, line: int) -> str:
        """Return the text of a paragraph, with the marks of Text."""
        parts: list[str] = []
        children = iter(inline.children or ())
        shown = values_shown(inline.content, self._values)
        for child in children:
            if child.type == "text":
                parts.append(filled(literal(child.content), self._values, self._file, shown))
            elif child.type == "softbreak":
                parts.append(" ")
            elif child.type == "code_inline":
                parts.append(mark_text(filled(literal(child.content), self._values, self._file, shown), "code"))
            elif child.type == "math_inline":
                parts.append(f"${filled(child.content, self._values, self._file, {}, mathematics=True)}$")
            elif child.type in ("em_open", "link_open"):
                parts.append(self._around(child, children, line, shown))
            else:
                raise self._refused(child, line)
        return "".join(parts)

    def _around(self, opening: Token, children: Iterator[Token], line: int, shown: Mapping[int, str]) -> str:
        closing, words = opening.type.replace("_open", "_close"), []
        for child in children:
            if child.type == closing:
                break
            if child.type not in ("text", "softbreak"):
                raise ProseError(self._file, line, "emphasis and links hold plain words only")
            words.append(filled(literal(child.content), self._values, self._file, shown) or " ")
        text = "".join(words)
        return mark_text(text, "emphasis") if opening.type == "em_open" else link_text(text, str(opening.attrs["href"]))

    def _refused(self, token: Token, line: int) -> ProseError:
        what = _NAMES.get(token.type, token.type.removesuffix("_open").replace("_", " "))
        return ProseError(self._file, line, f"a report has no {what}; it has paragraphs, lists, emphasis, code, links")


def _is_block(value: Any) -> bool:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return all(_is_block(each) for each in value)  # of none, as where no run failed, nothing is shown
    return dataclasses.is_dataclass(value) and isinstance(value, ReportBlock | Section)


def values_shown(text: str, values: ChapterValues) -> dict[int, str]:
    """Return the measured values of a text as strings, by placeholder: those of a sentence in one unit if that reads.

    Args:
        text: Sentences with placeholders.
        values: The values of the chapter.
    """
    shown: dict[int, str] = {}
    for sentence in _SENTENCES.split(text):
        numbers = dict.fromkeys(int(number) for number in PLACEHOLDER.findall(sentence))
        measured = {number: own for number in numbers if isinstance(own := values.found[number][0], Measured)}
        for unit in {each.unit for each in measured.values() if smaller_units(each.unit)}:
            sizes = {
                number: each.value or 0.0 for number, each in measured.items() if each.unit == unit and _has_size(each)
            }
            shown |= zip(sizes, in_one_unit([*sizes.values()], unit), strict=True)
    return shown


def filled(text: str, values: ChapterValues, file: str, shown: Mapping[int, str], mathematics: bool = False) -> str:
    """Return a string with its placeholders replaced by their values. No value can become markup.

    Args:
        text: The string.
        values: The values of the chapter.
        file: Name of the chapter's file.
        shown: How measured values are shown, by placeholder; see values_shown.
        mathematics: True if the string is between dollar signs, where only numbers may be inserted.

    Raises:
        ProseError: if a value is nothing that a sentence shows.
    """

    def show(found: re.Match[str]) -> str:
        value, line = values.found[int(found[1])]
        text = shown.get(int(found[1])) or _shown(value)
        if text is None or (mathematics and not isinstance(value, int | float)):
            what = "a formula takes numbers" if mathematics else "a sentence takes texts, numbers and measured values"
            hint = "; put a block in a separate paragraph" if not mathematics else ""
            raise ProseError(file, line, f"{what}, not {type(value).__name__}{hint}")
        return PRIVATE.sub("\ufffd", text).replace("$", "$$")

    return PLACEHOLDER.sub(show, text)


def _has_size(measured: Measured) -> bool:
    """Tell if a value is finite and above rounding errors."""
    return measured.value is not None and ROUNDING <= abs(measured.value) < math.inf


def _shown(value: Any) -> str | None:
    if isinstance(value, bool):
        return None
    if isinstance(value, str | Measured):
        return str(value)
    return number(value) if isinstance(value, int | float) else None
