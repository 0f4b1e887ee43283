"""Cache of function results by argument, for sweep cells with a mostly common config."""

from collections.abc import Callable
from types import FunctionType, MethodType
from typing import Any, TypeVar, cast

T = TypeVar("T")

_BY_VALUE = frozenset({int, float, bool, str, FunctionType, MethodType})  # types that are compared by value


class Memory:
    """Cache of function results by argument; the least recently used results are removed.

    Two arguments are the same if they are the same object, or equal numbers, strings or functions. The cache keeps
    references to the arguments, so that their identities stay unique. The arguments must not be changed.

    Args:
        kept: Number of stored results, to a factor of two.
    """

    def __init__(self, kept: int) -> None:
        self._most = kept // 2
        self._recent: dict[tuple[object, ...], tuple[tuple[object, ...], object]] = {}
        self._older: dict[tuple[object, ...], tuple[tuple[object, ...], object]] = {}

    def recall(self, function: Callable[..., T], *parts: Any) -> T:
        """Return the result of a function for the given arguments; an exception is not cached."""
        return self.known((function, *parts), lambda: function(*parts))

    def known(self, parts: tuple[object, ...], make: Callable[[], T]) -> T:
        """Return the cached result for `parts`; `make` computes it at the first call and must depend on them only."""
        key = tuple([(kind, part) if (kind := type(part)) in _BY_VALUE else id(part) for part in parts])
        found = self._recent.get(key)
        if found is None:
            found = self._older.get(key) or (parts, make())
            if len(self._recent) >= self._most:
                self._older, self._recent = self._recent, {}
            self._recent[key] = found
        return cast(T, found[1])
