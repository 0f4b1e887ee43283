"""Episodes of LeRobot data sets, and of tables with a column of episodes."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from runner.base.bounded_json import decode_json
from runner.base.errors import RunnerError, TableError
from runner.base.limits import LOG_FILES, RECORDING, ExcessError, read_text
from runner.base.parquet import number_columns, open_columns
from runner.base.sanitize import quoted
from runner.base.tables import NumericTable

INFO = Path("meta", "info.json")
"""File by which a LeRobot data set is recognised."""

EPISODE = "episode_index"


def one_episode(table: NumericTable, episode: int | None) -> NumericTable:
    """Return the rows of an episode of a table with a column of episodes; None for the longest.

    Raises:
        TableError: if it has no such episode.
    """
    numbers, counts = np.unique(table.columns[EPISODE], return_counts=True)
    chosen, form = _chosen(table.path, dict(zip(numbers.astype(int).tolist(), counts.tolist(), strict=True)), episode)
    kept = table.columns[EPISODE] == chosen
    lines = None if table.lines is None else table.lines[kept]
    columns = {name: column[kept] for name, column in table.columns.items()}
    return replace(table, form=f"{table.form}, {form}", columns=columns, lines=lines)


def read_lerobot(path: Path, episode: int | None) -> NumericTable:
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
    return _read_episode(path, files, episode, names)


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


def _read_episode(
    path: Path, files: Sequence[Path], episode: int | None, names: Mapping[str, Sequence[str]]
) -> NumericTable:
    lengths: dict[int, int] = {}
    places: dict[int, Path] = {}
    for file in files:
        for number, count in zip(
            *np.unique(open_columns(file, [EPISODE])[EPISODE].to_numpy(), return_counts=True), strict=True
        ):
            lengths[int(number)] = lengths.get(int(number), 0) + int(count)
            places[int(number)] = file
    chosen, form = _chosen(path, lengths, episode)
    table = open_columns(places[chosen])
    columns, others = number_columns(table.filter(table[EPISODE].to_numpy() == chosen), names)
    return NumericTable(path, f"LeRobot data set, {form}", columns, others=others)


def _chosen(path: Path, lengths: Mapping[int, int], episode: int | None) -> tuple[int, str]:
    """Return an episode by the lengths of all, and words for it."""
    if not lengths:
        raise TableError(path, "has no rows. Allowed: a data set with episodes.")
    chosen = max(lengths, key=lambda number: (lengths[number], -number)) if episode is None else episode
    if chosen not in lengths:
        raise TableError(path, f"has no episode {chosen}. Allowed: {min(lengths)} to {max(lengths)}.")
    longest = f", the longest of {min(lengths)} to {max(lengths)}" if episode is None and len(lengths) > 1 else ""
    return chosen, f"episode {chosen}{longest}"


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
