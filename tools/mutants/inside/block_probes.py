"""The blocks that ran: one byte each, in a file that a test's process shares with those that it starts."""

import functools
import mmap
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

_least_recently_used = functools.lru_cache


def _opened() -> mmap.mmap:
    with Path(os.environ["BLOCKS_HITS"]).open("r+b") as file:
        return mmap.mmap(file.fileno(), 0)


hits = _opened()


def hit(index: int) -> None:
    """Say that a block of one expression runs."""
    hits[index] = 1


def taken() -> bytes:
    """Return the blocks that ran, and begin again."""
    seen = hits[:]
    hits[:] = bytes(len(seen))
    return seen


def add(seen: bytes) -> None:
    """Count blocks as run."""
    hits[:] = together(hits[:], seen)


def together(one: bytes, other: bytes) -> bytes:
    """Return the blocks that ran in either."""
    return (int.from_bytes(one, "little") | int.from_bytes(other, "little")).to_bytes(len(one), "little")


def lru_cache(maxsize: Any = 128, typed: bool = False) -> Any:
    """Do what functools.lru_cache does; whoever is given a kept value has run what made it."""
    if callable(maxsize):
        return _kept(maxsize, 128, typed)
    return lambda function: _kept(function, maxsize, typed)


def _kept(function: Callable[..., Any], maxsize: int | None, typed: bool) -> Any:
    module = sys.modules.get(getattr(function, "__module__", None) or "")
    if os.environ["BLOCKS_ROOT"] not in (getattr(module, "__file__", None) or ""):
        return _least_recently_used(maxsize, typed)(function)

    @_least_recently_used(maxsize, typed)
    def make(*arguments: Any, **named: Any) -> tuple[Any, bytes]:
        before = taken()
        try:
            return function(*arguments, **named), hits[:]
        finally:
            add(before)

    @functools.wraps(function)
    def give(*arguments: Any, **named: Any) -> Any:
        value, seen = make(*arguments, **named)
        add(seen)
        return value

    for name in ("cache_info", "cache_clear", "cache_parameters"):
        setattr(give, name, getattr(make, name))
    return give
