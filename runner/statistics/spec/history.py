"""History of bounds and claims, with the date on which each value was first set.

`set_after` returns this date for a value that was set after the result was known.
"""

import time
from collections.abc import Mapping, Sequence
from typing import Any

from runner.config.judgement import Bound

History = Sequence[Sequence[Any]]
"""Dates on which bounds or claims were first set, each with its value; the first stood when the result was made."""
Histories = Mapping[str, History]


def today() -> str:
    """Return the date as it is stored, such as "2026-11-24", in UTC."""
    return time.strftime("%Y-%m-%d", time.gmtime())


def ends_of(bound: Bound | None) -> list[float | None]:
    """Return the ends of a bound as a history has them; None is no bound."""
    return [None, None] if bound is None else [bound.min, bound.max]


def settings(bounds: Mapping[str, Bound | None], date: str) -> Histories:
    """Return histories that begin with some bounds."""
    return {metric: [[date, ends_of(bound)]] for metric, bound in bounds.items()}


def merge_histories(*histories: Histories) -> dict[str, list[Sequence[Any]]]:
    """Return histories one after the other, each value with the date on which it was first set."""
    found: dict[str, list[Sequence[Any]]] = {}
    for name, history in (item for each in histories for item in each.items()):
        known = found.setdefault(name, [])
        known += [[date, value] for date, value in history if value not in [old for _, old in known]]
    return found


def set_after(history: History, value: Any) -> tuple[str, Sequence[Any]]:
    """Return when a value was set after the result was known, and what stood before; no date where it was not."""
    values = [old for _, old in history]
    place = values.index(value) if value in values else 0
    return (str(history[place][0]), values[:place]) if place else ("", ())
