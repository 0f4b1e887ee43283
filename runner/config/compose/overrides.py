"""Overrides: syntax errors, checks before Hydra parses them, and a form in which Hydra composes unknown keys."""

import re
from collections.abc import Iterator, Sequence

from runner.base.bounded_yaml import CONFIG
from runner.base.dotted_keys import calls_function
from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.config.compose.files import SAYS_HOW, groups, outside_error
from runner.config.compose.units import with_numbers

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


_CHARACTERS = 20_000  # Hydra needs a few seconds for a list of this length
_MAY_BE_TYPED = re.compile(r"[+]*hydra\.sweeper\.(workers|address|params(\.[^@:]*)?)")
_LOOKS_LIKE_A_VALUE = re.compile(r"(?i)(null|true|false|[-+.\d][-+.\de]*)$")


def prepare(overrides: Sequence[str]) -> list[str]:
    """Check overrides; return them with ranges in SI units, and with each option of a group as a name.

    Hydra would read an option such as `noise=1` as a number, and its message would not contain the group.

    Raises:
        ConfigError: for an override that is too long, nested too deeply or malformed, that sets a key of Hydra, names
            no option of a group or calls a function, and for a range in a unit that does not fit its key.
    """
    names = set(groups())
    problems = [problem for override in overrides if (problem := _problem(override, names))]
    if problems:
        raise ConfigError(problems)
    return [_named(with_numbers(override), names) for override in overrides]


def _named(override: str, names: set[str]) -> str:
    key, _, value = override.partition("=")
    return f"{key}='{value}'" if key in names and _LOOKS_LIKE_A_VALUE.match(value) else override


def force(overrides: Sequence[str]) -> list[str]:
    """Return prepared overrides in a form in which Hydra composes unknown keys.

    Validation then reports all unknown keys, with the nearest valid keys. Hydra would stop at the first and suggest to
    add the key, which the runner would never read.

    Raises:
        ConfigError: see `prepare`.
    """
    names = "|".join(map(re.escape, groups()))
    unknown = re.compile(rf"(?!hydra|(?:{names})=)[A-Za-z_][\w.]*=")
    return [f"++{line}" if unknown.match(line) else line for line in prepare(overrides)]


def _problem(override: str, names: set[str]) -> str | None:
    key, given, value = override.partition("=")
    if override.startswith("-"):  # a flag
        return f"{override}: a pickle may run code; give the overrides again" if override.startswith("--e") else None
    if len(override) > _CHARACTERS:
        return f"{quoted(override)} is not a valid override: it is too long; allowed: up to {_CHARACTERS} characters"
    if _depth(value) + key.count(".") > CONFIG.depth:
        return f"{quoted(override)} is not a valid override: nested deeper than {CONFIG.depth} levels"
    if calls_function(override.replace("\\", "")):  # Hydra takes them away
        return f"{quoted(override)} calls a function; a value may only refer to keys, as in ${{robot.period}}"
    fault = find_syntax_error(override)
    if fault:
        return f"{quoted(override)} is not a valid override: {fault}"
    group = key.lstrip("+~").partition("@")[0]
    if (says := SAYS_HOW.search(key)) and says[1] == "hydra" and not _MAY_BE_TYPED.fullmatch(key):
        return f"{key}: is Hydra's own; you may set hydra.sweeper.workers, .address and .params; folders: --config-dir"
    if given and group in names and (not value or "${" in value):
        return f"{group}: {quoted(value)} is not an option; choose by name, see `runner list`"
    if group in names and "{" not in value and ".." in value.split("/"):
        return outside_error(f"{group}/{value}").problems[0]
    return None


def _depth(text: str) -> int:
    """Return the depth of nested brackets in a string."""
    deepest = depth = 0
    for sign in text:
        depth += (sign in "[{(") - (sign in ")}]")
        deepest = max(deepest, depth)
    return deepest
