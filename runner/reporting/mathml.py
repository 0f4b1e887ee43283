"""Typst mathematics as MathML, by Typst's own HTML export."""

import re
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path

import typst

from runner.reporting import outline
from runner.reporting.document import Document
from runner.reporting.templating import CodeText, typst_environment

# A hash sign starts Typst code, which could read files: formulas have no use for it.
_CODE = "#"
_FORMULA = re.compile(r"<p>(.*?)</p>", re.DOTALL)
_KEPT = 5000  # formulas of one process, more than all reports have
_made: dict[tuple[str, bool], CodeText | None] = {}
# Browsers put a combining accent to the left of its letter.
_ACCENTS = {"\u0302": "\u02c6", "\u0307": "\u02d9", "\u0308": "\u00a8", "\u0303": "\u02dc", "\u20d7": "\u2192"}
_TALL = frozenset(("mfrac", "mtable", "msqrt", "munder", "munderover"))  # what brackets grow with
_WHOLE = 12  # most symbols of a formula in a line of text that does not break
_BEFORE, _BEHIND = frozenset("=≈≠≤≥<>→+−±"), frozenset(",;")  # where a longer one breaks


def mathml(texts: Iterable[str], *, displayed: bool) -> dict[str, CodeText | None]:
    """Return each formula as MathML, or None if it is not valid Typst mathematics.

    Args:
        texts: Formulas in Typst mathematics, without dollar signs.
        displayed: True if each is on a separate line.
    """
    wanted = list(dict.fromkeys(texts))
    if len(_made) + len(wanted) > _KEPT:
        _made.clear()
    missing = [text for text in wanted if (text, displayed) not in _made]
    _made.update({(text, displayed): found for text, found in _compile(missing, displayed).items()})
    return {text: _made[text, displayed] for text in wanted}


def all_mathml(document: Document) -> dict[bool, dict[str, CodeText | None]]:
    """Return all formulas of a document as MathML, by whether they are displayed."""
    displayed, inline = outline.formulas(document)
    return {True: mathml(displayed, displayed=True), False: mathml(inline, displayed=False)}


def faulty(document: Document) -> list[str]:
    """Return the formulas of a document that Typst refuses; the report shows them as they are written."""
    return [text for found in all_mathml(document).values() for text, made in found.items() if made is None]


def _compile(texts: list[str], displayed: bool) -> dict[str, CodeText | None]:
    allowed = [text for text in texts if _CODE not in text]
    result: dict[str, CodeText | None] = dict.fromkeys(texts)
    if not allowed:
        return result
    try:
        return result | dict(zip(allowed, _exported(allowed, displayed), strict=True))
    except typst.TypstError:
        if len(allowed) == 1:
            return result
    # One of them is wrong: halves find it in few compilations, and the good ones are still made.
    middle = len(allowed) // 2
    return result | _compile(allowed[:middle], displayed) | _compile(allowed[middle:], displayed)


def _exported(texts: list[str], displayed: bool) -> list[CodeText]:
    source = typst_environment().get_template("mathml.typ.j2").render(texts=texts, displayed=displayed)
    # The folder holds nothing else: whatever a formula tries to read does not exist.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "mathml.typ")
        path.write_text(source, encoding="utf-8")
        page = typst.compile(path, root=path.parent, format="html", ignore_system_fonts=True).decode()
    return [CodeText("".join(_tidied(ET.fromstring(each)))) for each in _FORMULA.findall(page)]  # noqa: S314 - by Typst


def _tidied(formula: ET.Element) -> Iterator[str]:
    """Yield a formula with spacing accents; a long one in a line of text in pieces, between which the line breaks."""
    for each in formula.iter():
        for name in ("style", "scriptlevel", *(() if each.find(".//mfrac") is not None else ("displaystyle",))):
            each.attrib.pop(name, None)  # without an effect here
        if each.tag == "mo" and len(each):
            each.text, each[:] = each[0].text, []  # a line of the source, which the export makes a string
        if each.tag == "mo" and each.text in _ACCENTS:
            each.text = _ACCENTS[each.text]
            each.set("stretchy", "false")
        if each.tag == "mrow" and len(each) > 1 and not any(part.tag in _TALL for part in each.iter()):
            for sign in (each[0], each[-1]):
                if sign.tag == "mo":
                    sign.set("stretchy", "false")  # Chromium leaves space around a stretchy one
        for before, marked in pairwise(each):
            if marked.get("class") == "differs" and before.tag != "mo" and marked[0].text in _BEFORE:
                marked[0].set("form", "infix")  # the first sign in a row would be a prefix, without a space
    pieces = [[*formula]]
    if "display" not in formula.attrib and sum(1 for each in formula.iter() if each.text) > _WHOLE:
        pieces = list(_pieces(formula))
    for piece in pieces:
        formula[:] = piece
        yield ET.tostring(formula, encoding="unicode")


def _pieces(formula: ET.Element) -> Iterator[list[ET.Element]]:
    piece: list[ET.Element] = []
    for each in formula:
        sign = each[0] if each.get("class") and len(each) else each  # the first one of what differs
        text = (sign.text or "") if sign.tag == "mo" else ""
        if piece and text in _BEFORE and piece[-1].tag != "mo":
            yield piece
            piece = []
            sign.set("form", "infix")
        piece.append(each)
        if text in _BEHIND:
            yield piece
            piece = []
    if piece:
        yield piece
