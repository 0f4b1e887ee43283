"""Overrides: checks before Hydra parses them, and a form in which Hydra composes unknown keys."""

import re
from collections.abc import Sequence

from runner.base.bounded_yaml import CONFIG
from runner.base.errors import ConfigError
from runner.base.interpolation import calls_function
from runner.base.sanitize import quoted
from runner.config.compose.options import groups
from runner.config.compose.syntax_errors import find_syntax_error
from runner.config.compose.units import with_numbers
from runner.config.compose.user_settings import SAYS_HOW

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
    return None


def _depth(text: str) -> int:
    """Return the depth of nested brackets in a string."""
    deepest = depth = 0
    for sign in text:
        depth += (sign in "[{(") - (sign in ")}]")
        deepest = max(deepest, depth)
    return deepest
