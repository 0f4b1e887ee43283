"""Shards: files with many finished runs of a large sweep that have no trace.

`outputs/shards/NUMBER-COMMAND-PLACE.DIGEST.parquet` has a row for each run: its hash, its failure, the number of its
caveats, and the values of each metric. The row also has the config, URDF and record in the format of a run's folder.
The record has no metrics if they follow from the values; the column `metrics` has their names in order.

A shard is written once, as a whole, and its name contains the digest of its content. NUMBER counts the commands that
wrote shards, so that the later of two shards is known without a clock.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.atomic import write_atomically
from runner.base.bounded_json import decode_json
from runner.base.limits import ExcessError, open_parquet
from runner.base.machine import Machine, read_machine
from runner.store.names import Names, Texts
from runner.store.parquet import encode_parquet, list_column, numbers, plain_column, text_column
from runner.store.record import find_config_faults, find_faults
from runner.store.run import Run
from runner.store.seal import SCHEMA, DamagedError, SchemaError, digest, encode_finite

_COLUMNS = ("run", "config", "urdf", "record", "metrics")
_SHARED = ["failure", "urdf", "metrics", "machine"]  # columns with many equal rows
_CUT_SHORT = 2  # rank of an aborted run
_MACHINE = "machine"
METRIC = "metric "
"""Prefix of the name of a metric's column."""

_HEX = 24  # digits of the digest in a name
_REMEDY = "remove it, and the sweep's command simulates its runs again"


@dataclass(frozen=True)
class RunOutcome:
    """Outcome of a finished run.

    Attributes:
        name: Hash of the run.
        failure: Message with the time, location and reason of the failure; empty for a good run.
        cut_short: Whether the run was aborted, for example by its time limit, instead of failing in the simulation.
        caveats: Number of caveats, reasons why the result may mislead.
        machine: Machine that made the run.
    """

    name: str
    failure: str
    cut_short: bool
    caveats: int = 0
    machine: Machine = field(default=Machine(), compare=False)

    @property
    def rank(self) -> int:
        """Rank: of two outcomes of one run the lower counts. 0 is a good run, 1 a failed run, 2 an aborted run."""
        return _CUT_SHORT if self.cut_short else 1 if self.failure else 0


@dataclass(frozen=True)
class ShardRow:
    """A run without trace as the row of a shard.

    Attributes:
        outcome: Outcome of the run.
        config: Resolved config, as JSON.
        urdf: URDF of the robot.
        record: Record of the run, as JSON; without metrics if there are at most MOST_LISTED repetitions.
        metrics: Names and units of the metrics.
        values: Values of the metrics, shape (repetitions, metrics), NaN for none.
    """

    outcome: RunOutcome
    config: str
    urdf: str
    record: str
    metrics: tuple[tuple[str, str], ...]
    values: FloatArray


def outcome(run: Run) -> RunOutcome:
    """Return the outcome of a run."""
    failure, machine = run.failure_record, read_machine(run.record.get("provenance", {}).get("machine"))
    cut_short = failure is not None and failure["time"] is None
    return RunOutcome(run.hash, run.failure or "", cut_short, len(run.caveats), machine)


def shard_files(outputs: Path) -> list[Path]:
    """Return the shards of an outputs folder, later ones last."""
    return sorted((outputs / "shards").glob("*.parquet"))


def next_number(outputs: Path) -> int:
    """Return the number of the next command that writes shards."""
    numbers = [path.name.partition("-")[0] for path in shard_files(outputs)]
    return 1 + max((int(number) for number in numbers if number.isdecimal()), default=0)


def shard_name(number: int, command: str, place: int) -> str:
    """Return the name of a shard without its digest.

    Args:
        number: Number of the command; see next_number.
        command: Random name of the command, because commands that start together have one number.
        place: Number of the shard in the command.
    """
    return f"{number:020d}-{command}-{place:06d}"


def find_shards(outputs: Path, name: str) -> list[Path]:
    """Return the files with a shard's name; empty before it is written."""
    return sorted((outputs / "shards").glob(f"{name}.*parquet"))


def lists_values(repetitions: int) -> bool:
    """Return True if a record lists the values of each repetition, so that a shard stores them as columns."""
    from runner.metrics.summary import MOST_LISTED  # all metrics, which only a writer needs

    return repetitions <= MOST_LISTED


def _row_of(run: Run) -> ShardRow:
    metrics = tuple((name, metric.unit) for name, metric in run.metrics.items())
    values = np.array([run.values(name) for name in run.metrics]).T if metrics else np.zeros((0, 0))
    listed = lists_values(len(values))
    record = {key: value for key, value in run.record.items() if key != "metrics" or not listed}
    return ShardRow(outcome(run), json.dumps(run.config), run.urdf, encode_finite(record), metrics, values)


def write_shard(outputs: Path, name: str, runs: Sequence[Run | ShardRow]) -> Path:
    """Store runs without trace in one file, and return its path.

    Raises:
        StoreError: if the file cannot be written.
    """
    import pyarrow

    rows = [_row_of(run) if isinstance(run, Run) else run for run in runs]
    ends = [row.outcome for row in rows]
    machines = {machine: encode_finite(machine.record()) for machine in {end.machine for end in ends}}
    columns = {
        "run": text_column([end.name for end in ends]),
        "failure": text_column([end.failure for end in ends]),
        "cut_short": plain_column(np.array([end.cut_short for end in ends], dtype=bool)),
        "config": text_column([row.config for row in rows]),
        "urdf": text_column([row.urdf for row in rows]),
        "record": text_column([row.record for row in rows]),
        "metrics": text_column([json.dumps([name for name, _ in row.metrics]) for row in rows]),
        "caveats": plain_column(np.array([end.caveats for end in ends], dtype=np.int32)),
        _MACHINE: text_column([machines[end.machine] for end in ends]),
    }
    fields = [pyarrow.field(name, column.type) for name, column in columns.items()]
    measured = list(metric_columns([(row.metrics, row.values) for row in rows]))
    table = pyarrow.Table.from_arrays(
        [*columns.values(), *(column for _, column in measured)],
        schema=pyarrow.schema([*fields, *(field for field, _ in measured)], {"schema": str(SCHEMA)}),
    )
    content = encode_parquet(table, use_dictionary=_SHARED, write_statistics=False)
    path = outputs / "shards" / f"{name}.{digest(content)[:_HEX]}.parquet"
    write_atomically(path, content)
    return path


@dataclass(eq=False)
class Outcomes(Sequence[RunOutcome]):
    """Outcomes of runs in shards, in a few bytes each.

    Attributes:
        names: Name of each run, shape (n,).
        rank: Rank of each run, shape (n,); see Outcome.
        caveats: Number of caveats of each run, shape (n,).
        failures: Failures by index, only of failed runs.
        machines: Machine that made each run, shape (n,).
    """

    names: Texts
    rank: NDArray[np.int8]
    caveats: NDArray[np.int32]
    failures: Mapping[int, str]
    machines: NDArray[np.object_]

    def __len__(self) -> int:
        return len(self.names)

    def __getitem__(self, row: Any) -> Any:
        if isinstance(row, slice):
            return [self[each] for each in range(*row.indices(len(self)))]
        row = range(len(self))[row]
        failure, name = self.failures.get(row, ""), self.names[row].decode()
        cut_short = bool(self.rank[row] == _CUT_SHORT)
        return RunOutcome(name, failure, cut_short, int(self.caveats[row]), self.machines[row])


def read_outcomes(path: Path) -> Outcomes:
    """Return the outcomes of the runs of a shard.

    Raises:
        DamagedError: if the shard cannot be read, or differs from what was written.
        SchemaError: if the shard has another schema.
    """
    columns = ("run", "failure", "cut_short", "caveats")
    table = read_columns(path, columns, _MACHINE)
    try:
        names, failures, cut_short, caveats = (table[name].to_pylist() for name in columns)
        rank = np.where(cut_short, _CUT_SHORT, np.array(failures, dtype=object) != "").astype(np.int8)
        failed = {row: text for row, text in enumerate(failures) if text}
        return Outcomes(Names.of(names).texts, rank, np.array(caveats, dtype=np.int32), failed, _machines(table))
    except (AttributeError, TypeError, ValueError) as error:
        raise DamagedError(f"cannot read {path}: it is not a shard: {error}; {_REMEDY}") from error


def _machines(table: Any) -> NDArray[np.object_]:
    """Return the machine of each row of a shard, shape (n,); unknown ones if an earlier version wrote the shard."""
    if _MACHINE not in table.column_names:
        return np.full(len(table), Machine(), dtype=object)
    texts = table[_MACHINE].to_pylist()
    known = {text: read_machine(json.loads(text)) for text in set(texts)}
    return np.array([known[text] for text in texts], dtype=object)


def open_row(path: Path, row: int) -> Run:
    """Open the run in a row of a shard.

    Raises:
        DamagedError: if the shard cannot be read, or differs from what was written.
        SchemaError: if the shard has another schema.
    """
    values = _read_once(path, _COLUMNS)
    try:
        config, record, names = (decode_json(values[column][row].as_py()) for column in ("config", "record", "metrics"))
        if "metrics" not in record:
            record["metrics"] = _summarize(_read_once(path, (), METRIC), row, names)
        fault = find_faults(record) or find_config_faults(config)
    except (KeyError, ValueError, TypeError) as error:
        fault = str(error)
    if fault:
        raise DamagedError(f"cannot read {path}: row {row} is not a run: {fault}; {_REMEDY}")
    folder = path.parent.parent / "runs" / values["run"][row].as_py()
    return Run(folder, config, record, values["urdf"][row].as_py(), beside=partial(_values_in, path, row))


def _summarize(table: Any, row: int, names: Sequence[str]) -> dict[str, dict[str, object]]:
    """Return the metrics of a row in the format of the record in a run's folder."""
    from runner.metrics.summary import over_repetitions

    if not names:
        return {}
    values = np.array([numbers(table[METRIC + name][row].values) for name in names])
    found = {}
    for name, own, ends in zip(names, values.tolist(), over_repetitions(values).tolist(), strict=True):
        unit = table.field(METRIC + name).metadata[b"unit"].decode()
        median, low, high = (None if math.isnan(value) else value for value in ends)
        each = [None if math.isnan(value) else value for value in own]
        found[name] = {"unit": unit, "values": each, "median": median, "min": low, "max": high}
    return found


def _values_in(path: Path, row: int, metric: str) -> FloatArray:
    """Return the values of a metric of the run in a row of a shard, shape (repetitions,), NaN for none."""
    return numbers(read_columns(path, [METRIC + metric])[METRIC + metric][row].values)


def metric_columns(runs: Sequence[tuple[tuple[tuple[str, str], ...], FloatArray]]) -> Iterator[tuple[Any, Any]]:
    """Yield the field and the column of values of each metric. Such columns are read faster than the records.

    Args:
        runs: Names and units of the metrics of each run, and their values, shape (repetitions, metrics), NaN for none.
    """
    import pyarrow

    sets: dict[tuple[tuple[str, str], ...], int] = {}
    which = np.array([sets.setdefault(metrics, len(sets)) for metrics, _ in runs])
    sizes = np.array([len(values) for _, values in runs])
    of_value = np.repeat(which, sizes)
    parts = [
        np.concatenate([runs[row][1] for row in np.flatnonzero(which == place).tolist()]) for place in range(len(sets))
    ]
    for metric in dict.fromkeys(metric for metrics in sets for metric in metrics):
        flat = np.full(len(of_value), np.nan)
        for place, metrics in enumerate(sets):
            if metric in metrics:
                flat[of_value == place] = parts[place][:, metrics.index(metric)]
        has = np.array([metric in metrics for metrics in sets])
        column = list_column(flat[has[of_value]], np.where(has[which], sizes, 0), has[which])
        yield pyarrow.field(METRIC + metric[0], column.type, metadata={"unit": metric[1]}), column


def read_columns(path: Path, columns: Sequence[str], start: str = "") -> Any:
    """Return some columns of a shard, and those whose names have a prefix such as METRIC, as a pyarrow.Table.

    Raises:
        DamagedError: if the shard cannot be read, or differs from what was written.
        SchemaError: if the shard has another schema.
    """
    import pyarrow

    try:
        content = path.read_bytes()
        if digest(content)[:_HEX] != path.name.split(".")[1]:
            raise DamagedError(
                f"cannot read {path}: it is damaged: its content has another digest than named; {_REMEDY}"
            )
        file = open_parquet(pyarrow.BufferReader(content))
        schema = (file.schema_arrow.metadata or {}).get(b"schema", b"none").decode(errors="replace")
        if schema != str(SCHEMA):
            raise SchemaError(path, schema)
        wanted = [*columns, *(name for name in file.schema_arrow.names if start and name.startswith(start))]
        table = file.read(wanted, use_threads=False)
    except (OSError, ExcessError, pyarrow.ArrowException) as error:
        raise DamagedError(f"cannot read {path}: {str(error).splitlines()[0]}; {_REMEDY}") from error
    if table.column_names != wanted:
        raise DamagedError(f"cannot read {path}: it is not a shard: it needs columns {', '.join(columns)}; {_REMEDY}")
    return table


_read_once = lru_cache(maxsize=8)(read_columns)  # runs are read in order, which is nearly the order of the shards
