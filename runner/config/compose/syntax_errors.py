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
    """Return the syntax error of an override KEY=VALUE, and its repair; None if none is found."""
    key, given, value = override.partition("=")
    if not given:
        return None
    if key != key.strip() or value != value.lstrip() or " " in key:
        return f"remove the spaces around the '=', as in {quoted(f'{key.strip()}={value.strip()}')}"
    if not key:
        return "the key before the '=' is missing"
    if value.startswith("="):
        return "there are two '=' in a row; remove one"
    return next(_faults(value), None)


def explain_parser(text: str) -> str:
    """Return Hydra's message for an override, or a plain one if Hydra names tokens of its parser."""
    if not _OF_THE_PARSER.match(text):
        return text
    return (
        "it must read KEY=VALUE; a value with signs such as ( ) [ ] { } ^ # ; & ! needs quotes inside those of the "
        "shell, as in \"KEY='VALUE'\""
    )


def _faults(value: str) -> Iterator[str]:
    """Yield the errors in quotes, brackets and commas of a value."""
    open_ones: list[str] = []
    before, quote = "", ""  # the last sign except spaces; the open quote
    signs = iter(value)
    for sign in signs:
        if sign == "\\":
            next(signs, "")  # an escaped sign
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
        yield "a value after the last comma is missing; remove the comma, or give one more value"


def _at(sign: str, before: str, open_ones: list[str]) -> Iterator[str]:
    """Yield the errors at a sign outside of quotes, and update the open brackets."""
    if sign == "," and before in ("", ",", "(", "[", "{"):
        yield "a value before a comma is missing; remove the comma, or give the value"
    if sign in _CLOSING:
        open_ones.append(sign)
    elif sign in _CLOSING.values():
        if not open_ones or _CLOSING[open_ones.pop()] != sign:
            yield f"the bracket '{sign}' closes none that is open"
        if before == ",":
            yield f"a value between a comma and '{sign}' is missing; remove the comma, or give one more value"
