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
    """Return metrics in each repetition, each of shape (repetitions,), as Parquet; NaN, for no value, becomes null."""
    import pyarrow
    import pyarrow.parquet

    table = pyarrow.Table.from_arrays([optional_column(column) for column in values.values()], list(values))
    buffer = io.BytesIO()
    pyarrow.parquet.write_table(table, buffer, compression="zstd", use_dictionary=False, use_byte_stream_split=True)
    return buffer.getvalue()


def open_parquet(content: bytes, path: Path) -> Any:
    """Return the content of a file as a pyarrow.parquet.ParquetFile.

    Raises:
        DamagedError: if the content is not Parquet; names the file.
    """
    import pyarrow

    try:
        return limits.open_parquet(pyarrow.BufferReader(content))
    except (OSError, limits.ExcessError, pyarrow.ArrowException) as error:
        raise _damaged(path, error) from error


def read_table(file: Any, path: Path, columns: Sequence[str] | None = None) -> Any:
    """Return columns of a file from `open_parquet`; None for all. The `read_table` of pyarrow would import pandas.

    Raises:
        DamagedError: if the columns cannot be read; names the file.
    """
    import pyarrow

    try:
        return file.read(columns)
    except (OSError, pyarrow.ArrowException) as error:
        raise _damaged(path, error) from error


def read_column(file: Any, path: Path, name: str) -> FloatArray:
    """Return one column of numbers, shape (rows,), NaN for null.

    Raises:
        DamagedError: if the column does not exist; names the file.
    """
    table = read_table(file, path, [name])
    if table.column_names != [name]:
        raise DamagedError(f"cannot read {path}: it has no column {name}; {MEND}")
    column: FloatArray = table[name].combine_chunks().to_numpy(zero_copy_only=False).astype(np.float64, copy=False)
    return column


def _damaged(path: Path, error: Exception) -> DamagedError:
    return DamagedError(f"cannot read {path}: {str(error).splitlines()[0]}; {MEND}")
