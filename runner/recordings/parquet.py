"""Tables in Parquet files, and episodes of LeRobot data sets."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.bounded_json import decode_json
from runner.base.errors import RunnerError
from runner.base.limits import LOG_FILES, RECORDING, RECORDING_NUMBERS, ExcessError, open_parquet, read_text
from runner.base.sanitize import quoted
from runner.base.tables import Table

INFO = Path("meta", "info.json")
"""File by which a LeRobot data set is recognised."""

EPISODE = "episode_index"
_WIDEST = 1000  # numbers in a cell


def read_parquet(path: Path, episode: int | None = None) -> Table:
    """Return the columns of a Parquet file; a list of numbers in each cell becomes columns NAME.0, NAME.1 and so on.

    Args:
        path: The file.
        episode: The only episode to read, where the file has a column of episodes; None for its longest.

    Raises:
        RunnerError: if it is not such a file, or lacks the episode.
        ExcessError: if it is too large.
    """
    table = _table(path)
    if EPISODE not in table.column_names:
        columns, others = _columns(table, {})
        return Table(path, "Parquet", columns, others=others)
    return _episode(path, [path], episode, {})


def read_lerobot(path: Path, episode: int | None) -> Table:
    """Return an episode of a LeRobot data set, with the names that it gives to states and actions.

    Raises:
        RunnerError: if it cannot be read, or lacks the episode.
        ExcessError: if it is too large.
    """
    try:
        features = json_object(path / INFO).get("features", {})
        names = {str(name): _names(feature) for name, feature in features.items()}
    except (ValueError, AttributeError, TypeError) as error:
        raise RunnerError(f"cannot read {path / INFO}: {error}") from error
    files = sorted((path / "data").glob("*/*.parquet"))
    if excess := LOG_FILES.excess(len(files)):
        raise ExcessError(f"it {excess}")
    if not files:
        raise RunnerError(f"{path}: has no data/*/*.parquet. Allowed: a whole LeRobot data set.")
    return _episode(path, files, episode, names)


def json_object(path: Path) -> Mapping[str, Any]:
    """Return the content of a JSON file with an object.

    Raises:
        ValueError: if it is none.
    """
    content = decode_json(read_text(path, RECORDING))
    if not isinstance(content, dict):
        raise ValueError("it is not a JSON object")
    return content


def _names(feature: Any) -> list[str]:
    names = feature.get("names") if isinstance(feature, dict) else None
    while isinstance(names, dict) and len(names) == 1:  # {"motors": [...]}, as version 2 writes it
        (names,) = names.values()
    return [str(name) for name in names] if isinstance(names, list) else []


def _episode(path: Path, files: Sequence[Path], episode: int | None, names: Mapping[str, Sequence[str]]) -> Table:
    lengths: dict[int, int] = {}
    places: dict[int, Path] = {}
    for file in files:
        for number, count in zip(
            *np.unique(_table(file, [EPISODE])[EPISODE].to_numpy(), return_counts=True), strict=True
        ):
            lengths[int(number)] = lengths.get(int(number), 0) + int(count)
            places[int(number)] = file
    if not lengths:
        raise RunnerError(f"{path}: has no rows. Allowed: a data set with episodes.")
    chosen = max(lengths, key=lambda number: (lengths[number], -number)) if episode is None else episode
    if chosen not in lengths:
        raise RunnerError(f"{path}: has no episode {chosen}. Allowed: {min(lengths)} to {max(lengths)}.")
    table = _table(places[chosen])
    columns, others = _columns(table.filter(_equal(table[EPISODE], chosen)), names)
    form = f"LeRobot data set, episode {chosen}" if len(files) > 1 or names else f"Parquet, episode {chosen}"
    if episode is None and len(lengths) > 1:
        form += f", the longest of {min(lengths)} to {max(lengths)}"
    return Table(path, form, columns, others=others)


def _equal(column: Any, value: int) -> Any:
    import pyarrow.compute

    return pyarrow.compute.equal(column, value)


def _table(path: Path, columns: list[str] | None = None) -> Any:
    import pyarrow

    try:
        file = open_parquet(path, RECORDING)
        if excess := RECORDING_NUMBERS.excess(file.metadata.num_rows * file.metadata.num_columns):
            raise ExcessError(f"it {excess}")
        return file.read(columns)
    except pyarrow.ArrowException as error:
        raise RunnerError(f"{path}: is not a Parquet file: {str(error).splitlines()[0]}") from error


def _columns(table: Any, names: Mapping[str, Sequence[str]]) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    """Return the columns of numbers by name, and the names of the other ones."""
    found: dict[str, FloatArray] = {}
    others: list[str] = []
    for name in table.column_names:
        parts = list(_numbers(name, table[name], names.get(name, ())))
        found.update(parts)
        if not parts:
            others.append(name)
    return found, tuple(others)


def _numbers(name: str, column: Any, parts: Sequence[str]) -> Iterator[tuple[str, FloatArray]]:
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
    found: FloatArray = (counts - counts[0]) / per_second if len(counts) else np.empty(0)
    return found


def calibration_of(path: Path) -> dict[str, Mapping[str, float]]:
    """Return the ranges of a LeRobot calibration file of a data set, by motor; empty without one.

    Raises:
        RunnerError: if a file of that name cannot be read.
    """
    found_files = (
        [*path.glob("*calibration*.json"), *(path / "meta").glob("*calibration*.json")] if path.is_dir() else []
    )
    for file in sorted(found_files)[:1]:
        try:
            found = json_object(file)
            return {
                str(motor): {key: float(values[key]) for key in ("range_min", "range_max")}
                for motor, values in found.items()
            }
        except (OSError, ValueError, TypeError, KeyError, json.JSONDecodeError) as error:
            raise RunnerError(f"{file}: is not a calibration of LeRobot ({quoted(str(error))})") from error
    return {}
