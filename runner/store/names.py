"""Compact arrays of run names: 24 bytes each in memory, 12 in a file."""

from collections.abc import Iterable, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

_HEX = 24  # digits of a name
_BYTES = 12

Texts = NDArray[np.bytes_]


class Names(Sequence[str]):
    """Names of runs, 24 bytes each; a string takes three times as much.

    Args:
        texts: The names as ASCII, shape (n,).

    Attributes:
        texts: Names as given.
    """

    def __init__(self, texts: Texts) -> None:
        self.texts = texts

    @classmethod
    def of(cls, names: Iterable[str]) -> "Names":
        """Return names that are given as strings."""
        return cls(np.array([name.encode() for name in names], dtype=np.bytes_).reshape(-1))

    @classmethod
    def unpacked(cls, content: bytes) -> "Names":
        """Return names from their stored bytes, 12 bytes each."""
        return cls(np.frombuffer(content.hex().encode(), dtype=f"S{_HEX}"))

    def packed(self) -> bytes:
        """Return the stored bytes of the names, 12 bytes each; all names must be hexadecimal."""
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


def look_up(names: Texts, ordered: Texts) -> NDArray[np.intp]:
    """Return the index of each name in an ascending array, shape (n,); -1 for a missing name.

    Args:
        names: Names to look up, shape (n,).
        ordered: Names in ascending order, shape (m,).
    """
    if not len(ordered):
        return np.full(len(names), -1, dtype=np.intp)
    places = np.minimum(np.searchsorted(ordered, names), len(ordered) - 1)
    found: NDArray[np.intp] = np.where(ordered[places] == names, places, -1)
    return found


def best_of_each(names: Texts, *badness: NDArray[Any]) -> NDArray[np.intp]:
    """Return the index of the best entry of each distinct name, by ascending name.

    Args:
        names: Name of each entry, shape (n,).
        badness: Sort keys for the entries of one name, most important first, shape (n,) each; the smallest is best.
    """
    order = np.lexsort((*badness[::-1], names))
    first = np.ones(len(order), dtype=bool)
    first[1:] = names[order[1:]] != names[order[:-1]]
    chosen: NDArray[np.intp] = order[first]
    return chosen
