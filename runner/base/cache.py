"""Cache of function results by argument, for sweep cells with a mostly common config."""

from collections.abc import Callable
from types import FunctionType, MethodType
from typing import Any, TypeVar, cast

T = TypeVar("T")

_BY_VALUE = frozenset({int, float, bool, str, FunctionType, MethodType})  # the types of what is so compared


class Memory:
    """Results of functions, each for the arguments that it was given; those not asked for lately are forgotten.

    Two arguments are the same where they are one object, or equal numbers, texts or functions. They are held, so that
    no other object takes their identity, and must not be changed.

    Args:
        kept: Number of results kept, to a factor of two.
    """

    def __init__(self, kept: int) -> None:
        self._most = kept // 2
        self._recent: dict[tuple[object, ...], tuple[tuple[object, ...], object]] = {}
        self._older: dict[tuple[object, ...], tuple[tuple[object, ...], object]] = {}

    def recall(self, function: Callable[..., T], *parts: Any) -> T:
        """Return what a function gives for some arguments; one that raises is called again the next time."""
        return self.known((function, *parts), lambda: function(*parts))

    def known(self, parts: tuple[object, ...], make: Callable[[], T]) -> T:
        """Return what follows from some parts alone, as `make` gives it where they are met for the first time."""
        key = tuple([(kind, part) if (kind := type(part)) in _BY_VALUE else id(part) for part in parts])
        found = self._recent.get(key)
        if found is None:
            found = self._older.get(key) or (parts, make())
            if len(self._recent) >= self._most:
                self._older, self._recent = self._recent, {}
            self._recent[key] = found
        return cast(T, found[1])
