"""Arrays of NumPy's zip files (.npz) as columns: one with as many rows as the others is a signal of the log."""

import zipfile
from collections import Counter
from pathlib import Path
from typing import IO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import TableError
from runner.base.limits import RECORDING, RECORDING_NUMBERS, ExcessError
from runner.base.tables import NumericTable

_WIDEST = 1000  # columns of an array


def read_arrays(path: Path, archive: zipfile.ZipFile) -> NumericTable:
    """Return the columns of an opened zip file of arrays: NAME of a vector, NAME_0, NAME_1 and so on of a matrix.

    A matrix of one column is a vector, and another one may have its rows along either axis. Arrays of objects, which
    would have to be unpickled, are not read.

    Raises:
        TableError: if no array is a signal, or one is damaged.
        ExcessError: if it is too large.
    """
    items = [item for item in archive.infolist() if item.filename.endswith(".npy")]
    if excess := RECORDING.excess(sum(item.file_size for item in items)):
        raise ExcessError(f"it {excess}, unpacked")
    arrays: dict[str, NDArray[np.generic]] = {}
    others: dict[str, str] = {}
    for item in items:
        name = item.filename.removesuffix(".npy")
        try:
            with archive.open(item) as file:
                found = _read(file, item.file_size)
        except (ValueError, EOFError) as error:
            raise TableError(path, f"{item.filename} is damaged: {error}") from error
        if found is not None and found.size and (found.ndim == 1 or (found.ndim == 2 and min(found.shape) <= _WIDEST)):
            arrays[name] = found
        else:
            others[name] = ""
    if not arrays:
        raise TableError(path, "has no arrays of numbers. Allowed: vectors, and matrices with a row for each time.")
    (rows, _), *_ = Counter(max(found.shape) for found in arrays.values()).most_common(1)
    columns: dict[str, FloatArray] = {}
    for name, found in arrays.items():
        if max(found.shape) != rows:
            others[name] = ""
        elif min(found.shape) == 1 or found.ndim == 1:
            columns[name] = found.astype(np.float64).ravel()
        else:
            matrix = found.astype(np.float64) if len(found) == rows else found.T.astype(np.float64)
            columns |= {f"{name}_{place}": matrix[:, place] for place in range(matrix.shape[1])}
    if excess := RECORDING_NUMBERS.excess(rows * len(columns)):
        raise ExcessError(f"it {excess}")
    return NumericTable(path, "arrays of NumPy", columns, others=others)


def _read(file: IO[bytes], size: int) -> NDArray[np.generic] | None:
    """Return an array of numbers; None for another one. Its header must not promise more bytes than there are."""
    version = npy.read_magic(file)
    header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, by_columns, dtype = header(file)
    if dtype.kind not in "fiub":
        return None
    count = int(np.prod([int(length) for length in shape], dtype=object)) if shape else 1
    if count * dtype.itemsize > size:
        raise ValueError(f"it has {size:,} bytes, and its header promises more")
    found = np.frombuffer(file.read(count * dtype.itemsize), dtype=dtype)
    return found.reshape(shape, order="F" if by_columns else "C")
