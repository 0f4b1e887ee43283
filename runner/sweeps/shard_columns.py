"""Runs of a shard in columns, with their records parsed as JSON by pyarrow all at once."""

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.store.shards import METRIC, read_columns

_SEED = '"seed": '


@dataclass(frozen=True)
class Columns:
    """Runs of a shard.

    Attributes:
        names: Name of each.
        failures: When, where and why each failed; empty for a good one.
        seeds: Seed of each, shape (n,).
        caveats: Why the result of each may not be what it seems.
        rules: Digest and thresholds of the rules that found these, None for none, each with the number of runs.
        settings: The runs that have the same config but for the seed, by what tells it apart.
        made_by: Distinct values of commit, machine, date and versions.
        metrics: By name: unit; the runs that have it; and its values, shape (runs, repetitions), NaN behind the last
            repetition of a run, infinite where a repetition has none.
    """

    names: Sequence[str]
    failures: Sequence[str]
    seeds: NDArray[np.int64]
    caveats: Sequence[Sequence[Mapping[str, Any]]]
    rules: Sequence[tuple[Mapping[str, Any] | None, int]]
    settings: Mapping[object, NDArray[np.intp]]
    made_by: Mapping[str, Sequence[str]]
    metrics: Mapping[str, tuple[str, NDArray[np.intp], NDArray[np.float64]]]


def read_shard(path: Path, rows: NDArray[np.intp]) -> Columns | None:
    """Return runs of a shard; None where these are better opened one by one, as they have little in common.

    Args:
        path: The shard.
        rows: Their rows, shape (n,).

    Raises:
        DamagedError: if it cannot be read, or is not as it was written.
    """
    import pyarrow

    table = read_columns(path, ("run", "failure", "config", "record")).take(rows)
    of_metrics = [name for name in table.column_names if name.startswith(METRIC)]
    try:
        record = _parsed(table["record"].to_pylist())
        provenance = record.field("provenance")
        seeds = provenance.field("seed").to_numpy()
        rules = _rules(record)
        caveats = _caveats(record)
        metrics = {name: (unit, *_rows(values)) for name, unit, values in _metrics(table.select(of_metrics))}
        made_by = dict(_made_by(provenance))
    except (pyarrow.ArrowException, KeyError):
        return None  # of two kinds of values in one place
    if rules is None or seeds.dtype.kind != "i":
        return None
    settings = {key: np.array(members) for key, members in _settings(table["config"].to_pylist()).items()}
    names, failures = table["run"].to_pylist(), table["failure"].to_pylist()
    return Columns(names, failures, seeds, caveats, rules, settings, made_by, metrics)


def _parsed(records: Sequence[str]) -> Any:
    """Return records given as JSON as one struct array."""
    import pyarrow
    import pyarrow.json

    content = "\n".join(records).encode()
    text, number = pyarrow.string(), pyarrow.float64()
    caveat = pyarrow.struct({"rule": text, "text": text, "value": number})
    known = pyarrow.schema({
        "caveats": pyarrow.list_(caveat),
        "provenance": pyarrow.struct({"date": text, "commit": text, "machine": text, "command": text}),
    })  # fmt: skip
    table = pyarrow.json.read_json(
        io.BytesIO(content),
        read_options=pyarrow.json.ReadOptions(use_threads=False, block_size=len(content) + 1),
        parse_options=pyarrow.json.ParseOptions(explicit_schema=known),
    )
    return table.to_struct_array().combine_chunks()


def _settings(configs: Sequence[str]) -> dict[object, list[int]]:
    """Return which configs, given as JSON, are the same but for their seed, by what tells them apart."""
    found: dict[object, list[int]] = {}
    for place, text in enumerate(configs):
        before, _, after = text.partition(_SEED)
        key = (text,) if _SEED in after else (before, after.partition(",")[2])
        found.setdefault(key, []).append(place)
    return found


def _rules(record: Any) -> list[tuple[Mapping[str, Any] | None, int]] | None:
    """Return the rules that found caveats, each with the number of runs; None where they differ between runs."""
    if record.type.get_field_index("caveat_rules") < 0:
        return [(None, len(record))]
    rules = _inner(record, "caveat_rules").drop_null()
    if any(len(leaf.unique()) > 1 for leaf in _leaves(rules)):
        return None
    found: list[tuple[Mapping[str, Any] | None, int]] = [(rules[0].as_py(), len(rules))] if len(rules) else []
    return [*found, (None, len(record) - len(rules))] if len(rules) < len(record) else found


def _leaves(array: Any) -> Iterator[Any]:
    import pyarrow

    if isinstance(array, pyarrow.StructArray):
        for inner in array.flatten():
            yield from _leaves(inner)
    else:
        yield array


def _caveats(record: Any) -> list[Sequence[Mapping[str, Any]]]:
    """Return the caveats of each run; runs with the same ones share them."""
    found = _inner(record, "caveats")
    counts = np.nan_to_num(found.value_lengths().to_numpy(zero_copy_only=False)).astype(int).tolist()
    columns = [column.to_pylist() for column in found.flatten().flatten()]
    names = [field.name for field in found.type.value_type]
    every = iter(zip(*columns, strict=True))
    shared: dict[object, Sequence[Mapping[str, Any]]] = {}
    lists: list[Sequence[Mapping[str, Any]]] = []
    for count in counts:
        own = tuple(next(every) for _ in range(count))
        if own not in shared:
            shared[own] = tuple(dict(zip(names, values, strict=True)) for values in own)
        lists.append(shared[own])
    return lists


def _made_by(provenance: Any) -> Iterator[tuple[str, Sequence[str]]]:
    """Yield distinct values of what made the runs."""
    from runner.sweeps.gathering import commit_text

    yield "commit", [commit_text(value) for value in provenance.field("commit").unique().to_pylist()]
    yield "machine", provenance.field("machine").unique().to_pylist()
    versions = provenance.field("versions")
    for field in versions.type:
        yield field.name, [value for value in versions.field(field.name).unique().to_pylist() if value is not None]
    yield "made on", provenance.field("date").unique().to_pylist()


def _metrics(table: Any) -> Iterator[tuple[str, str, Any]]:
    """Yield name, unit and values of each metric from its column."""
    for field in table.schema:
        unit = (field.metadata or {}).get(b"unit", b"").decode()
        yield field.name.removeprefix(METRIC), unit, table[field.name].combine_chunks()


def _rows(values: Any) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return which runs have a metric, and its values, shape (runs, repetitions); see Columns."""
    counts = values.value_lengths().to_numpy(zero_copy_only=False)
    members = np.flatnonzero(~np.isnan(counts.astype(float)))
    sizes = counts[members].astype(int)
    flat = values.flatten().to_numpy(zero_copy_only=False).astype(float)
    rows = np.full((len(members), int(sizes.max(initial=0))), np.nan)
    rows[np.arange(rows.shape[1]) < sizes[:, None]] = np.where(np.isnan(flat), np.inf, flat)
    return members, rows


def _inner(array: Any, name: str) -> Any:
    """Return a field of a struct array, missing where the struct is."""
    return array.flatten()[array.type.get_field_index(name)]
