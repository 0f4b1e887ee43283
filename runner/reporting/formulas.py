"""Typst mathematics as SVG images, with one Typst compilation for each document and a cache."""

import json
import re
import tempfile
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


def faulty(document: Document) -> list[str]:
    """Return the formulas of a document that Typst refuses; the report shows them as they are written."""
    displayed, inline = outline.formulas(document)
    images = [*draw(displayed, displayed=True).items(), *draw(inline, displayed=False).items()]
    return [text for text, image in images if image is None]


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
