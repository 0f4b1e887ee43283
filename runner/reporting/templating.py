"""Jinja2 environments: HTML with autoescape, and Typst with every string quoted."""

import html
import re
from collections.abc import Callable
from functools import cache
from typing import Any

import jinja2

from runner.base.paths import templates_dir
from runner.base.sanitize import plain
from runner.reporting.document import Origin
from runner.reporting.markup import spans
from runner.reporting.verdicts import WORDS

_BEFORE_UNIT = re.compile(
    r"(?<=[\d⁰¹²³⁴⁵⁶⁷⁸⁹]) (?=(?:%|[mµ]?m|[mµ]?s|m/s²?|N²?|rad(?:/s)?|J|kg|Hz|°|pairs?)(?![\w/]))", re.ASCII
)
_INSIDE_UNIT = re.compile(
    r"(?<=[\d⁰¹²³⁴⁵⁶⁷⁸⁹]\u00a0N) (?=m\b)|(?<=\(N) (?=m\b)|(?<=[\u00a0(]N²) (?=m²)|(?<=m²) (?=s\b)"
)
_PART_OF_NAME = re.compile(r"(?<=[_=/,(])|(?<=\.)(?!\d)")
_SIZE = re.compile(r'viewBox="[-\d.]+ [-\d.]+ ([\d.]+) ([\d.]+)"')


class CodeText(str):
    """Text that is code of the target language already, and is inserted unchanged."""

    __slots__ = ()

    def __html__(self) -> str:
        return self


@cache
def html_environment() -> jinja2.Environment:
    """Return the environment of the HTML templates: autoescape on, an unknown name is an error."""
    return _environment(bound_html, finalize=html_value)


@cache
def typst_environment() -> jinja2.Environment:
    """Return the environment of the Typst templates.

    Its delimiters are `<% %>`, `<< >>` and `<# #>`. Whatever a template inserts becomes a Typst string or number, so
    that no text can become markup or code, not even where a template forgets a filter.
    """
    return _environment(
        bound_typst,
        finalize=typst_value,
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
    )


def html_value(value: object) -> object:
    """Return a string without the characters that no page can hold; autoescape does the rest."""
    return plain(value) if isinstance(value, str) and not hasattr(value, "__html__") else value


def typst_value(value: object) -> str:
    """Return a value as Typst code: a number, true or false, or a quoted string; the output of a macro stays unchanged.

    Raises:
        TypeError: If the value is anything else.
    """
    if isinstance(value, str):
        return value if hasattr(value, "__html__") else CodeText(quote_typst(value))
    if isinstance(value, bool):
        return CodeText(str(value).lower())
    if isinstance(value, int | float):
        return CodeText(repr(value))
    raise TypeError(f"a Typst template can insert strings and numbers, not {type(value).__name__}")


def quote_typst(text: str) -> str:
    """Return a string as a Typst string in quotes."""
    escaped = plain(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def origin_label(origin: Origin, kind: str) -> str:
    """Return a figure's or table's number in the source with the word before it, or an empty text."""
    number = plain(origin.number).strip()
    if not number:
        return ""
    return f"{kind} {number}" if number[0].isdigit() else number[0].upper() + number[1:]


def bind_units(text: str) -> str:
    """Return a string in which no line break parts a number from its unit."""
    return _INSIDE_UNIT.sub("\u00a0", _BEFORE_UNIT.sub("\u00a0", text))


def bound_html(text: str) -> CodeText:
    """Return a string as HTML in which numbers and units stay together."""
    return CodeText(bind_units(html.escape(plain(text))))


def bound_typst(text: str) -> CodeText:
    """Return a string as Typst code in which numbers and units stay together."""
    return CodeText(bind_units(quote_typst(text)))


def name_parts(text: str) -> list[CodeText]:
    """Return the parts of a string, such as a key of a config, between which a line may break; numbers stay whole."""
    return [bound_html(part) for part in _PART_OF_NAME.split(text)]


def aspect(svg: str) -> str:
    """Return width and height of a drawing as the style `aspect-ratio` has them."""
    size = _SIZE.search(svg)
    return f"{size[1]} / {size[2]}" if size else "auto"


def _environment(bound: Callable[[str], CodeText], **options: Any) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(templates_dir(), encoding="utf-8"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        **options,
    )
    environment.filters |= {
        "spans": spans,
        "origin_label": origin_label,
        "aspect": aspect,
        "bind_units": bound,
        "name_parts": name_parts,
    }
    environment.globals["verdict_words"] = WORDS
    return environment
