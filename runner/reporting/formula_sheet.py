"""Shared SVG definitions of letters and formulas on one page."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator

from runner.reporting.formulas import Image

_SVG = "{http://www.w3.org/2000/svg}"
_LINK = "{http://www.w3.org/1999/xlink}href"
_BLACK = {"#000", "#000000", "black"}
_DRAWN = {"g", "path", "use"}  # all that formulas are made of


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
        return "".join(self._definitions())

    def _definitions(self) -> Iterator[str]:
        for name, body in (*self._letters.values(), *self._formulas.values()):
            yield f'<g id="{name}">{body}</g>'

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
