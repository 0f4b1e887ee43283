"""Collection of the problems that checks find, for one report."""

from collections.abc import Callable, Sequence
from typing import TypeVar, overload

from runner.base.cache import Memory
from runner.base.errors import ConfigError

A = TypeVar("A")
B = TypeVar("B")
C = TypeVar("C")
D = TypeVar("D")
T = TypeVar("T")


class Problems:
    """Problems that checks have found so far.

    Args:
        memory: Cache of earlier results of checks for the same parts; None to run every check.

    Attributes:
        found: A message for each problem.
    """

    def __init__(self, memory: Memory | None = None) -> None:
        self.found: list[str] = []
        self._memory = memory

    @overload
    def attempt(self, check: Callable[[], T], /) -> T | None: ...
    @overload
    def attempt(self, check: Callable[[A], T], a: A | None, /) -> T | None: ...
    @overload
    def attempt(self, check: Callable[[A, B], T], a: A | None, b: B | None, /) -> T | None: ...
    @overload
    def attempt(self, check: Callable[[A, B, C], T], a: A | None, b: B | None, c: C | None, /) -> T | None: ...
    @overload
    def attempt(
        self, check: Callable[[A, B, C, D], T], a: A | None, b: B | None, c: C | None, d: D | None, /
    ) -> T | None: ...

    def attempt(self, check: Callable[..., T], /, *parts: object) -> T | None:
        """Return the result of a check of parts; None if one of the parts is None, or if the check finds a problem."""
        if any(part is None for part in parts):
            return None
        value, problems = _made(check, *parts)
        self.found += problems
        return value

    def recall(self, check: Callable[..., T], /, *parts: object) -> T | None:
        """Return the result of `attempt`, cached for equal parts; see Memory.recall."""
        for part in parts:
            if part is None:
                return None
        value, problems = _made(check, *parts) if self._memory is None else self._memory.recall(_made, check, *parts)
        self.found += problems
        return value

    def report(self) -> None:
        """End the checks.

        Raises:
            ConfigError: if one of them has found a problem.
        """
        if self.found:
            raise ConfigError(self.found)


def _made(check: Callable[..., T], *parts: object) -> tuple[T | None, Sequence[str]]:
    """Return the result of a check of parts, and the problems that it finds."""
    try:
        return check(*parts), ()
    except ConfigError as error:
        return None, error.problems


def require(value: T | None) -> T:
    """Return the result of a check that found no problem."""
    assert value is not None  # noqa: S101 - a check without result has found a problem
    return value
