"""Syntax errors of overrides, with messages that do not use the token names of Hydra's parser."""

import re
from collections.abc import Iterator

from runner.base.sanitize import quoted

_CLOSING = {"(": ")", "[": "]", "{": "}"}
_OF_THE_PARSER = re.compile(
    r"mismatched input|extraneous input|no viable alternative|token recognition|missing |LexerNoViableAlt|"
    r"Error parsing override|rule "
)


def find_syntax_error(override: str) -> str | None:
    """Return what is wrong with the form of KEY=VALUE, and how to mend it; None where nothing is seen."""
    key, given, value = override.partition("=")
    if not given:
        return None
    if key != key.strip() or value != value.lstrip() or " " in key:
        return f"remove the spaces beside the '=', as in {quoted(f'{key.strip()}={value.strip()}')}"
    if not key:
        return "there is no key before the '='"
    if value.startswith("="):
        return "there are two '=' in a row; remove one"
    return next(_faults(value), None)


def explain_parser(text: str) -> str:
    """Return what Hydra says of an override, in words where it speaks of its tokens."""
    if not _OF_THE_PARSER.match(text):
        return text
    return (
        "it must read KEY=VALUE; a value with signs such as ( ) [ ] { } ^ # ; & ! stands in quotes within those of the "
        "shell, as in \"KEY='VALUE'\""
    )


def _faults(value: str) -> Iterator[str]:
    """Yield what is wrong with quotes, brackets and commas of a value."""
    open_ones: list[str] = []
    before, quote = "", ""  # the last sign that is no space; the quote that is open
    signs = iter(value)
    for sign in signs:
        if sign == "\\":
            next(signs, "")  # what follows stands for itself
            before = sign
        elif quote:
            quote = "" if sign == quote else quote
        elif sign in "'\"" and before in ("", ",", "(", "[", "{", ":", "="):
            quote = before = sign
        elif not sign.isspace():
            yield from _at(sign, before, open_ones)
            before = sign
    if quote:
        yield f"the quote {quote} is not closed"
    if open_ones:
        yield f"the bracket '{open_ones[-1]}' is not closed by a '{_CLOSING[open_ones[-1]]}'"
    if before == ",":
        yield "nothing stands behind the last comma; remove it, or give one more value"


def _at(sign: str, before: str, open_ones: list[str]) -> Iterator[str]:
    """Yield what is wrong at a sign outside of quotes, and keep which brackets are open."""
    if sign == "," and before in ("", ",", "(", "[", "{"):
        yield "nothing stands before a comma; remove it, or give a value there"
    if sign in _CLOSING:
        open_ones.append(sign)
    elif sign in _CLOSING.values():
        if not open_ones or _CLOSING[open_ones.pop()] != sign:
            yield f"the bracket '{sign}' closes none that is open"
        if before == ",":
            yield f"nothing stands between a comma and '{sign}'; remove the comma, or give one more value"
