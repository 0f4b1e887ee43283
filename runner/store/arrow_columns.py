"""Parquet columns made from Arrow buffers, without the import of pandas (half a second)."""

from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyarrow

_MOST_BYTES = 2**31 - 1  # total size of the strings of a column


def text_column(values: Sequence[str]) -> "pyarrow.Array":
    """Return a column of strings.

    Raises:
        ValueError: if the strings take more than 2 GB.
    """
    import pyarrow

    encoded = [value.encode() for value in values]
    ends = np.array([0, *accumulate(map(len, encoded))])
    if ends[-1] > _MOST_BYTES:
        raise ValueError("the strings of a column take more than 2 GB")
    buffers = [None, pyarrow.py_buffer(ends.astype(np.int32)), pyarrow.py_buffer(b"".join(encoded))]
    return pyarrow.Array.from_buffers(pyarrow.string(), len(values), buffers)


def float_column(values: NDArray[np.float64]) -> "pyarrow.Array":
    """Return a column of numbers, shape (n,); NaN stays NaN."""
    import pyarrow

    return _plain(pyarrow.float64(), np.ascontiguousarray(values, dtype=np.float64), len(values))


def optional_column(values: NDArray[np.float64]) -> "pyarrow.Array":
    """Return a column of numbers, shape (n,), in which NaN is null."""
    import pyarrow

    numbers = np.ascontiguousarray(values, dtype=np.float64)
    buffers = [_unless_all(~np.isnan(numbers)), pyarrow.py_buffer(numbers)]
    return pyarrow.Array.from_buffers(pyarrow.float64(), len(numbers), buffers)


def whole_column(values: Sequence[int]) -> "pyarrow.Array":
    """Return a column of 32-bit integers."""
    import pyarrow

    return _plain(pyarrow.int32(), np.array(values, dtype=np.int32), len(values))


def truth_column(values: Sequence[bool]) -> "pyarrow.Array":
    """Return a column of booleans."""
    import pyarrow

    return _plain(pyarrow.bool_(), _bits(np.array(values, dtype=bool)), len(values))


def list_column(values: NDArray[np.float64], sizes: NDArray[np.intp], present: NDArray[np.bool_]) -> "pyarrow.Array":
    """Return a column of lists of numbers.

    Args:
        values: The numbers of all lists in order, shape (n,); NaN for none.
        sizes: Length of each list, shape (rows,); 0 if there is no list.
        present: True for each row that has a list, shape (rows,).
    """
    import pyarrow

    numbers = optional_column(values)
    offsets = pyarrow.py_buffer(np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32))
    kind = pyarrow.list_(pyarrow.float64())
    return pyarrow.Array.from_buffers(kind, len(sizes), [_unless_all(present), offsets], children=[numbers])


def _plain(kind: Any, values: NDArray[Any], count: int) -> "pyarrow.Array":
    import pyarrow

    return pyarrow.Array.from_buffers(kind, count, [None, pyarrow.py_buffer(values)])


def _bits(values: NDArray[np.bool_]) -> NDArray[np.uint8]:
    return np.packbits(values, bitorder="little")


def _unless_all(present: NDArray[np.bool_]) -> Any:
    """Return the Arrow validity bitmap of the entries; None if all are present."""
    import pyarrow

    return None if present.all() else pyarrow.py_buffer(_bits(present))
