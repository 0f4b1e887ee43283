"""Typst mathematics as SVG images, and the definitions that the images of one page share."""

import json
import re
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import typst

from runner.reporting import outline
from runner.reporting.document import Document
from runner.reporting.templating import typst_environment

# A hash sign starts Typst code, which could read files: formulas have no use for it.
_CODE = "#"
_SIZE = re.compile(r'viewBox="0 0 ([\d.]+) ([\d.]+)"')
_FONT_SIZE = 10.0
_KEPT = 5000  # formulas of one process, more than all reports have
_drawn: dict[tuple[str, bool], "Image | None"] = {}
_SVG = "{http://www.w3.org/2000/svg}"
_LINK = "{http://www.w3.org/1999/xlink}href"
_BLACK = {"#000", "#000000", "black"}
_DRAWN = {"g", "path", "use"}  # all that formulas are made of


@dataclass(frozen=True)
class Image:
    """A formula drawn, its measures in units of the font size.

    Attributes:
        svg: The drawing.
        width: Width [em].
        height: Height [em].
        depth: How far it reaches below the line of writing [em].
    """

    svg: str
    width: float
    height: float
    depth: float

    @property
    def view(self) -> str:
        """What of the drawing is shown: left, top, width and height in its own units."""
        return f"0 0 {self.width * _FONT_SIZE:g} {self.height * _FONT_SIZE:g}"


def draw(texts: Iterable[str], *, displayed: bool) -> dict[str, Image | None]:
    """Return the drawing of each formula, or None where it is no valid Typst mathematics.

    Args:
        texts: Formulas in Typst mathematics, without dollar signs.
        displayed: Whether they stand on a line of their own.
    """
    wanted = list(dict.fromkeys(texts))
    if len(_drawn) + len(wanted) > _KEPT:
        _drawn.clear()
    missing = [text for text in wanted if (text, displayed) not in _drawn]
    _drawn.update({(text, displayed): image for text, image in _compile(missing, displayed).items()})
    return {text: _drawn[text, displayed] for text in wanted}


def draw_all(document: Document) -> dict[bool, dict[str, Image | None]]:
    """Return the drawings of all formulas of a document, by whether they are displayed."""
    displayed, inline = outline.formulas(document)
    return {True: draw(displayed, displayed=True), False: draw(inline, displayed=False)}


def faulty(document: Document) -> list[str]:
    """Return the formulas of a document that Typst refuses; the report shows them as they are written."""
    return [text for images in draw_all(document).values() for text, image in images.items() if image is None]


def _compile(texts: list[str], displayed: bool) -> dict[str, Image | None]:
    allowed = [text for text in texts if _CODE not in text]
    result: dict[str, Image | None] = dict.fromkeys(texts)
    if not allowed:
        return result
    try:
        return result | dict(zip(allowed, _pages(allowed, displayed), strict=True))
    except typst.TypstError:
        if len(allowed) == 1:
            return result
    # One of them is wrong: halves find it in few compilations, and the good ones are still drawn.
    middle = len(allowed) // 2
    return result | _compile(allowed[:middle], displayed) | _compile(allowed[middle:], displayed)


def _pages(texts: list[str], displayed: bool) -> list[Image]:
    source = (
        typst_environment().get_template("formulas.typ.j2").render(texts=texts, displayed=displayed, size=_FONT_SIZE)
    )
    # The folder holds nothing else: whatever a formula tries to read, it is not there.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "formulas.typ")
        path.write_text(source, encoding="utf-8")
        compiler = typst.Compiler(path, root=folder, ignore_system_fonts=True)
        pages = compiler.compile(format="svg")
        depths = json.loads(compiler.query("<depth>", field="value"))
    drawings = [pages] if isinstance(pages, bytes) else list(pages or [])
    return [_image(page.decode(), depth) for page, depth in zip(drawings, depths, strict=True)]


def _image(svg: str, depth: float) -> Image:
    size = _SIZE.search(svg)
    width, height = (float(size[1]), float(size[2])) if size else (_FONT_SIZE, _FONT_SIZE)
    return Image(svg, width / _FONT_SIZE, height / _FONT_SIZE, depth / _FONT_SIZE)


class FormulaSheet:
    """The letters and formulas of a page; they take the colour of the text around them."""

    def __init__(self) -> None:
        self._letters: dict[str, tuple[str, str]] = {}  # by Typst's own name, which is a digest of the outline
        self._formulas: dict[str, tuple[str, str]] = {}  # by the drawing

    def name(self, image: Image) -> str:
        """Return the name under which a formula stands in the page."""
        if image.svg not in self._formulas:
            root = ET.fromstring(image.svg)  # noqa: S314 - Typst drew it
            for symbol in root.iter(f"{_SVG}symbol"):
                letter = symbol.get("id", "")
                if letter not in self._letters:
                    self._letters[letter] = f"g{len(self._letters)}", "".join(map(self._written, symbol))
            body = "".join(self._written(part) for part in root if part.tag != f"{_SVG}defs")
            self._formulas[image.svg] = f"f{len(self._formulas)}", body
        return self._formulas[image.svg][0]

    def definitions(self) -> str:
        """Return the content of the page's `<defs>`."""
        named = (*self._letters.values(), *self._formulas.values())
        return "".join(f'<g id="{name}">{body}</g>' for name, body in named)

    def _written(self, element: ET.Element) -> str:
        """Return an element and all in it, black as the colour of the text, with the page's names."""
        tag, children = element.tag.removeprefix(_SVG), list(element)
        if tag not in _DRAWN:
            return ""
        given = dict(element.attrib)
        if tag == "g" and len(children) == 1 and set(given) == {"transform"} and _at_origin(children[0]):
            children[0].set("transform", given["transform"])
            return self._written(children[0])
        if tag == "use":
            target = given.pop(_LINK, "").removeprefix("#")
            given |= {"href": f"#{self._letters[target][0]}"}
            given = {
                name: value for name, value in given.items() if name not in ("x", "y", "fill-rule") or value != "0"
            }
            given.pop("fill-rule", None)
        for paint in ("fill", "stroke"):
            if given.get(paint) in _BLACK:
                given[paint] = "currentColor"
        if given.get("fill") == "currentColor":
            del given["fill"]  # as the page's style has it
        inside = "".join(map(self._written, children))
        attributes = "".join(f' {name}="{_escaped(value)}"' for name, value in given.items())
        return f"<{tag}{attributes}>{inside}</{tag}>" if inside else f"<{tag}{attributes}/>"


def _at_origin(element: ET.Element) -> bool:
    return element.tag == f"{_SVG}use" and element.get("x", "0") == element.get("y", "0") == "0"


def _escaped(value: str) -> str:
    return value.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
