"""Arithmetic in the runs of a study, such as `{{ mass / 2 }}`, with named numbers and axis levels."""

import math
import re
from collections.abc import Mapping
from typing import Any

from runner.base.errors import RunnerError
from runner.base.expressions import insertions
from runner.base.expressions.evaluator import Budget, Scope
from runner.base.expressions.grammar import ExpressionError
from runner.base.sanitize import quoted

Level = str | int | float
"""What a name stands for: a number or a text."""

_LONGEST = 2000  # characters of a text with expressions
_OPERATIONS = 1000


def fill(text: str, scope: Mapping[str, Level]) -> str:
    """Return a text with its expressions worked out, numbers with nine digits at most: 1.0 is put in as "1".

    Args:
        text: The text, as "robot.mass={{ mass / 2 }}".
        scope: What each name stands for.

    Raises:
        RunnerError: if an expression is none, or has no value that can be put in.
    """
    if "{{" not in text:
        return text
    if len(text) > _LONGEST:
        raise RunnerError(f"{quoted(text)}: has {len(text)} characters; allowed: up to {_LONGEST}")
    try:
        return insertions.fill(text, Scope({"round": _rounded}, scope), Budget(_OPERATIONS), _shown)
    except ExpressionError as error:
        raise RunnerError(f"{quoted(text)}: {error.reason}") from None


def alone(text: str) -> str | None:
    """Return the name that an override consists of, as "mass" of "{{ mass }}"; None where there is more to it."""
    match = re.fullmatch(r"\{\{\s*([\w.]+)\s*\}\}", text)
    return match[1] if match else None


def names_in(text: str) -> set[str]:
    """Return the names in the expressions of a text."""
    pieces = [text[start:stop] for start, stop in insertions.insertions(text)]
    return {name for piece in pieces for name in re.findall(r"[A-Za-z_][\w.]*", piece)}


def _rounded(value: float, digits: float | None = None) -> float:
    return round(value) if digits is None else round(float(value), int(digits))  # of an int Python works out 10**digits


def _shown(value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise RunnerError(f"gives {quoted(value)}; only a finite number or a string can be inserted")
    return f"{value:.9g}"
