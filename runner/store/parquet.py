"""Parquet files: columns made from Arrow buffers, traces, and files with the values of many repetitions.

The columns need no import of pandas, which takes half a second.
"""

import io
from collections.abc import Mapping, Sequence
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from runner.base import limits
from runner.base.arrays import FloatArray
from runner.base.trace import Trace
from runner.store.seal import MEND, DamagedError

if TYPE_CHECKING:
    import pyarrow

VALUES_FILE = "values.parquet"
OF_NUMBERS = {"use_dictionary": False, "use_byte_stream_split": True}
"""Options of `encode_parquet` for a table of numbers."""

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


def plain_column(values: NDArray[Any]) -> "pyarrow.Array":
    """Return a column of numbers or booleans of the type of an array, shape (n,); NaN stays NaN."""
    import pyarrow

    content = _bits(values) if values.dtype == bool else np.ascontiguousarray(values)
    buffers = [None, pyarrow.py_buffer(content)]
    return pyarrow.Array.from_buffers(pyarrow.from_numpy_dtype(values.dtype), len(values), buffers)


def optional_column(values: NDArray[np.float64]) -> "pyarrow.Array":
    """Return a column of numbers, shape (n,), in which NaN is null."""
    import pyarrow

    numbers = np.ascontiguousarray(values, dtype=np.float64)
    buffers = [_unless_all(~np.isnan(numbers)), pyarrow.py_buffer(numbers)]
    return pyarrow.Array.from_buffers(pyarrow.float64(), len(numbers), buffers)


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


def _bits(values: NDArray[np.bool_]) -> NDArray[np.uint8]:
    return np.packbits(values, bitorder="little")


def _unless_all(present: NDArray[np.bool_]) -> Any:
    """Return the Arrow validity bitmap of the entries; None if all are present."""
    import pyarrow

    return None if present.all() else pyarrow.py_buffer(_bits(present))


def values_parquet(values: Mapping[str, FloatArray]) -> bytes:
    """Return metrics in each repetition, each of shape (repetitions,), as Parquet; NaN, for no value, becomes null."""
    import pyarrow

    columns = [optional_column(column) for column in values.values()]
    return encode_parquet(pyarrow.Table.from_arrays(columns, list(values)), **OF_NUMBERS)


def encode_parquet(table: "pyarrow.Table", **options: Any) -> bytes:
    """Return a table as Parquet; `pyarrow.parquet.write_table` has the options."""
    import pyarrow.parquet

    buffer = io.BytesIO()
    pyarrow.parquet.write_table(table, buffer, compression="zstd", **options)
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
        return file.read(columns, use_threads=False)  # see runner/base/limits.py
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
    return numbers(table[name])


def numbers(column: Any) -> FloatArray:
    """Return numbers in Arrow, in chunks or not, as an array of shape (rows,), NaN for null.

    The `to_numpy` of pyarrow would import pandas.

    Raises:
        DamagedError: if the column has no numbers.
    """
    import pyarrow

    try:
        column = column if column.type == pyarrow.float64() else column.cast(pyarrow.float64())
    except pyarrow.ArrowException as error:
        raise DamagedError(f"a column of type {column.type} has no numbers; {MEND}") from error
    parts = [np.empty(0)]
    for chunk in filter(len, getattr(column, "chunks", [column])):
        rows = slice(chunk.offset, chunk.offset + len(chunk))
        present, values = chunk.buffers()
        parts.append(np.frombuffer(values)[rows])
        if chunk.null_count:
            bits = np.unpackbits(np.frombuffer(present, np.uint8), bitorder="little")[rows]
            parts[-1] = np.where(bits, parts[-1], np.nan)
    return np.concatenate(parts)


def _damaged(path: Path, error: Exception) -> DamagedError:
    return DamagedError(f"cannot read {path}: {str(error).splitlines()[0]}; {MEND}")


def trace_table(trace: Trace) -> Any:
    """Return a trace as an Arrow table: one column per signal, its unit in the metadata of the column."""
    import pyarrow

    joints = range(trace.q.shape[1])
    columns: list[tuple[str, str, np.ndarray]] = [("t", "s", trace.t)]
    places = trace.joint_units
    speeds = [f"{unit}/s" for unit in places]
    torques = ["N" if unit == "m" else "N m" for unit in places]
    for name, units, values in (("q", places, trace.q), ("dq", speeds, trace.dq), ("tau", torques, trace.tau)):
        columns += [(f"{name}{joint + 1}", units[joint], values[:, joint]) for joint in joints]
    if trace.q_command is not None:
        columns += [(f"q{joint + 1}_command", places[joint], trace.q_command[:, joint]) for joint in joints]
    if trace.contact is not None:
        for name in ("external", "felt", "reading", "load", "reaction"):
            values = getattr(trace.contact, name)
            columns += [(f"{name}_force_{axis}", "N", values[:, index]) for index, axis in enumerate("xyz")]
            columns += [(f"{name}_moment_{axis}", "N m", values[:, 3 + index]) for index, axis in enumerate("xyz")]
    tip_signals = (
        ("tip", "m", trace.tip),
        ("error", "m", trace.error),
        ("desired", "m", trace.desired[:, 0]),
        ("desired_velocity", "m/s", trace.desired[:, 1]),
        ("desired_acceleration", "m/s^2", trace.desired[:, 2]),
    )
    for name, unit, values in tip_signals:
        columns += [(f"{name}_{axis}", unit, values[:, index]) for index, axis in enumerate("xyz")]
    for index, stage in enumerate(trace.stage_names[:-1]):
        stage_trace = trace.at_stage(index)
        for name, values in ((f"{stage}_tip", stage_trace.tip), (f"{stage}_error", stage_trace.error)):
            columns += [(f"{name}_{axis}", "m", values[:, number]) for number, axis in enumerate("xyz")]
    schema = pyarrow.schema(
        [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit}) for name, unit, _ in columns]
    )
    return pyarrow.Table.from_arrays([plain_column(values) for *_, values in columns], schema=schema)
