"""Columns of numbers of Parquet files."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from runner.base.arrays import FloatArray
from runner.base.errors import TableError
from runner.base.limits import RECORDING, RECORDING_NUMBERS, ExcessError, Limit, open_parquet

PARQUET = b"PAR1"
"""The first bytes of a Parquet file."""

_WIDEST = 1000  # numbers in a cell


def open_columns(path: Path, names: list[str] | None = None, limit: Limit = RECORDING) -> Any:
    """Return columns of a Parquet file as a table of pyarrow, all if names is None.

    Raises:
        TableError: if it is not such a file.
        ExcessError: if it is too large.
    """
    import pyarrow

    try:
        file = open_parquet(path, limit)
        if excess := RECORDING_NUMBERS.excess(file.metadata.num_rows * file.metadata.num_columns):
            raise ExcessError(f"it {excess}")
        return file.read(names, use_threads=False)
    except pyarrow.ArrowException as error:
        raise TableError(path, f"is not a Parquet file: {str(error).splitlines()[0]}") from error


def number_columns(table: Any, names: Mapping[str, Sequence[str]]) -> tuple[dict[str, FloatArray], dict[str, str]]:
    """Return the columns of numbers of a table of pyarrow by name, and the other ones, without a text.

    Args:
        table: The table; a list of numbers in each cell becomes columns NAME.0, NAME.1 and so on.
        names: Names of the numbers in such lists, by column.
    """
    found: dict[str, FloatArray] = {}
    others: dict[str, str] = {}
    for name in table.column_names:
        parts = list(_split(name, table[name], names.get(name, ())))
        found.update(parts)
        if not parts:
            others[name] = ""
    return found, others


def _split(name: str, column: Any, parts: Sequence[str]) -> Iterator[tuple[str, FloatArray]]:
    import pyarrow.types as types

    kind = column.type
    if types.is_integer(kind) or types.is_floating(kind):
        yield name, _floats(column)
    elif types.is_timestamp(kind) or types.is_duration(kind):
        yield name, _seconds(column.cast("int64"), kind.unit)
    elif types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind):
        inner = kind.value_type
        values = column.combine_chunks()
        lengths = set(values.value_lengths().to_pylist()) if len(column) else set()
        if not (types.is_integer(inner) or types.is_floating(inner)) or len(lengths) != 1 or None in lengths:
            return
        (width,) = lengths
        if not 0 < width <= _WIDEST:
            return
        numbers = _floats(values.flatten()).reshape(-1, width)
        labels = parts if len(parts) == width else [str(place) for place in range(width)]
        for place, label in enumerate(labels):
            yield f"{name}.{label}", numbers[:, place]


def _floats(column: Any) -> FloatArray:
    found: FloatArray = column.cast("float64").to_numpy(
        **({} if hasattr(column, "chunks") else {"zero_copy_only": False})
    )
    return found


def _seconds(column: Any, unit: str) -> FloatArray:
    """Return times from the first one on, in s: whole seconds since 1970 would leave too few digits."""
    counts = column.to_numpy()
    per_second = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[unit]
    found: FloatArray = (counts - counts[:1]) / per_second
    return found
