"""Values of many repetitions, in a Parquet file next to a run's record, with a column for each metric."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from runner.base import limits
from runner.base.arrays import FloatArray
from runner.store.arrow_columns import optional_column
from runner.store.seal import DamagedError
from runner.store.stored import MEND

VALUES_FILE = "values.parquet"


def values_parquet(values: Mapping[str, FloatArray]) -> bytes:
    """Return metrics in each repetition, each of shape (repetitions,), as Parquet: NaN, for none, is null there."""
    import pyarrow
    import pyarrow.parquet

    table = pyarrow.Table.from_arrays([optional_column(column) for column in values.values()], list(values))
    buffer = io.BytesIO()
    pyarrow.parquet.write_table(table, buffer, compression="zstd", use_dictionary=False, use_byte_stream_split=True)
    return buffer.getvalue()


def open_parquet(content: bytes, path: Path) -> Any:
    """Return a file's content as a pyarrow.parquet.ParquetFile.

    Raises:
        DamagedError: if it is none; names the file.
    """
    import pyarrow

    try:
        return limits.open_parquet(pyarrow.BufferReader(content))
    except (OSError, limits.ExcessError, pyarrow.ArrowException) as error:
        raise _damaged(path, error) from error


def read_table(file: Any, path: Path, columns: Sequence[str] | None = None) -> Any:
    """Return columns of a file that `open_parquet` gave, all where None; `read_table` of pyarrow would import pandas.

    Raises:
        DamagedError: if they cannot be read; names the file.
    """
    import pyarrow

    try:
        return file.read(columns)
    except (OSError, pyarrow.ArrowException) as error:
        raise _damaged(path, error) from error


def read_column(file: Any, path: Path, name: str) -> FloatArray:
    """Return one column of numbers, shape (rows,), NaN for null.

    Raises:
        DamagedError: if it is not there; names the file.
    """
    table = read_table(file, path, [name])
    if table.column_names != [name]:
        raise DamagedError(f"cannot read {path}: it has no column {name}; {MEND}")
    column: FloatArray = table[name].combine_chunks().to_numpy(zero_copy_only=False).astype(np.float64, copy=False)
    return column


def _damaged(path: Path, error: Exception) -> DamagedError:
    return DamagedError(f"cannot read {path}: {str(error).splitlines()[0]}; {MEND}")
