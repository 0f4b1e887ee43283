"""Compact arrays of run names: 24 bytes each in memory, 12 in a file."""

from collections.abc import Iterable, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

_HEX = 24  # digits of a name
_BYTES = 12

Texts = NDArray[np.bytes_]


class Names(Sequence[str]):
    """Names of runs, 24 bytes each, where a text takes three times as much.

    Args:
        texts: The names as ASCII, shape (n,).

    Attributes:
        texts: As given.
    """

    def __init__(self, texts: Texts) -> None:
        self.texts = texts

    @classmethod
    def of(cls, names: Iterable[str]) -> "Names":
        """Return names that were given as texts."""
        return cls(np.array([name.encode() for name in names], dtype=np.bytes_).reshape(-1))

    @classmethod
    def unpacked(cls, content: bytes) -> "Names":
        """Return names that were stored: 12 bytes each."""
        return cls(np.frombuffer(content.hex().encode(), dtype=f"S{_HEX}"))

    def packed(self) -> bytes:
        """Return the names as they are stored: 12 bytes each; all must be hexadecimal."""
        return bytes.fromhex(self.texts.astype(f"S{_HEX}").tobytes().decode())

    def __len__(self) -> int:
        return len(self.texts)

    @overload
    def __getitem__(self, place: int) -> str: ...
    @overload
    def __getitem__(self, place: slice) -> "Names": ...
    def __getitem__(self, place: int | slice) -> "str | Names":
        return Names(self.texts[place]) if isinstance(place, slice) else self.texts[place].decode()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]


def look_up(names: Texts, ordered: Texts) -> NDArray[np.intp]:
    """Return at which place of ascending names others stand, shape (n,); -1 for one that does not.

    Args:
        names: What is looked for, shape (n,).
        ordered: Where it is looked for, shape (m,).
    """
    if not len(ordered):
        return np.full(len(names), -1, dtype=np.intp)
    places = np.minimum(np.searchsorted(ordered, names), len(ordered) - 1)
    found: NDArray[np.intp] = np.where(ordered[places] == names, places, -1)
    return found


def best_of_each(names: Texts, *badness: NDArray[Any]) -> NDArray[np.intp]:
    """Return the place of the best entry of each distinct name, by ascending name.

    Args:
        names: Name of each entry, shape (n,).
        badness: What entries of one name are ordered by, most important first, shape (n,) each; the least is best.
    """
    order = np.lexsort((*badness[::-1], names))
    first = np.ones(len(order), dtype=bool)
    first[1:] = names[order[1:]] != names[order[:-1]]
    chosen: NDArray[np.intp] = order[first]
    return chosen
