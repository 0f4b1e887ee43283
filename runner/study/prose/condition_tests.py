"""Condition tests of a chapter: each condition must fail for some change of its values."""

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from runner.study.measured import Measured
from runner.study.prose.expressions import Values
from runner.study.prose.reader import Reading, Stated, conditions_of

_CHANGES: tuple[Callable[[float], float | None], ...] = (
    lambda value: 1000.0 * value,
    lambda value: value / 1000.0,
    lambda value: value + 1000.0,  # what is of the size of rounding, or none, becomes large by this alone
    lambda value: value - 1000.0,
)


def never_failing(file: str, reading: Reading) -> list[str]:
    """Return the conditions of a chapter that hold whichever of its named values is changed, with file and line.

    Each value that a `{% set %}` of the chapter names is made a thousand times as large and small, and larger and
    smaller by a thousand, one at a time.

    Args:
        file: Name of the chapter's file, for messages.
        reading: What its file makes.
    """
    return [
        f"{file}:{each.line}: holds: {each.expression}: no change of a named value makes it fail; name what it is "
        "about by {% set NAME = EXPRESSION %}, or leave it out"
        for each in reading.stated
        if not _may_fail(file, each, reading.values)
    ]


def _may_fail(file: str, stated: Stated, values: Values) -> bool:
    """Tell whether each condition of an expression fails for some change."""
    given = conditions_of(file, stated, values)
    fell = {
        index
        for instead in _changed(values.named)
        for index, condition in enumerate(conditions_of(file, stated, values, instead))
        if not condition.holds
    }
    return len(fell) == len(given)


def _changed(named: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for name, value in named.items():
        for change in _CHANGES:
            yield from ({name: other} for other in _each_changed(value, change))


def _each_changed(value: Any, change: Callable[[float], float | None]) -> Iterator[Any]:
    """Yield a value, which may be a list or group of them, with each measured value in it changed in turn."""
    if isinstance(value, Measured):
        if value.value is not None:
            yield dataclasses.replace(value, value=change(value.value), parts=())
    elif isinstance(value, Mapping):
        for name, own in value.items():
            yield from ({**value, name: other} for other in _each_changed(own, change))
    elif isinstance(value, list | tuple):
        for index, own in enumerate(value):
            yield from ([*value[:index], other, *value[index + 1 :]] for other in _each_changed(own, change))
