"""Shards: finished runs of large sweeps that kept no trace, some hundred to a file.

`outputs/shards/NUMBER-PLACE.DIGEST.parquet` has a row for each run: its hash, what went wrong, the number of its
caveats, and config, URDF and record as a run's folder holds them. A shard is written once and whole, and its name holds
its content's digest. The numbers count the commands that wrote shards, so that the later of two is known without a
clock.
"""

import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from runner.errors import StoreError
from runner.store.atomic import write_atomically
from runner.store.record import find_faults
from runner.store.run import Run, describe_failure
from runner.store.seal import SCHEMA, DamagedError, digest

_COLUMNS = ("run", "failure", "cut_short", "config", "urdf", "record")
_CAVEATS = "caveats"  # a column that shards from before there were any lack
_HEX = 24  # digits of the digest in a name
_MEND = "remove it, and the sweep's command makes its runs again"


@dataclass(frozen=True)
class Outcome:
    """How a finished run ended.

    Attributes:
        name: Its hash.
        failure: When, where and why it failed, in words; empty for a good run.
        cut_short: Whether something else than its physics ended it, as its time limit.
        caveats: Number of reasons why its result may not be what it seems; 0 where none has looked for any.
    """

    name: str
    failure: str
    cut_short: bool
    caveats: int = 0

    @property
    def rank(self) -> int:
        """Which of two outcomes of one run counts, the lower: 0 for a good one, 1 for a failed, 2 for a cut short."""
        return 2 if self.cut_short else 1 if self.failure else 0


@dataclass(frozen=True)
class ShardRun(Run):
    """A stored run without trace.

    Attributes:
        text: The URDF's text.
        whole: Whether its shard has a digest.
    """

    text: str
    whole: bool = True

    @property
    def sealed(self) -> bool:
        """Whether its shard has a digest; see Stored."""
        return self.whole

    @cached_property
    def urdf(self) -> str:
        """The URDF's text that was simulated."""
        return self.text

    @cached_property
    def _table(self) -> Any:
        command = self.provenance["command"]
        raise StoreError(f"run {self.hash} kept no trace (sweep.trace); this simulates it again with one: {command}")


def outcome(run: Run) -> Outcome:
    """Return how a run ended."""
    failure = run.failure
    if failure is None:
        return Outcome(run.hash, "", False, len(run.caveats))
    return Outcome(run.hash, describe_failure(failure), failure["time"] is None, len(run.caveats))


def shard_files(outputs: Path) -> list[Path]:
    """Return the shards of an outputs folder, later ones last."""
    return sorted((outputs / "shards").glob("*.parquet"))


def next_number(outputs: Path) -> int:
    """Return the number of the next command that writes shards."""
    numbers = [path.name.partition("-")[0] for path in shard_files(outputs)]
    return 1 + max((int(number) for number in numbers if number.isdecimal()), default=0)


def shard_name(number: int, place: int) -> str:
    """Return the name of a shard without its digest: of a command's number, and the shard's place in it."""
    return f"{number:020d}-{place:06d}"


def find_shards(outputs: Path, name: str) -> list[Path]:
    """Return the files of a shard's name: none before it is written."""
    return sorted((outputs / "shards").glob(f"{name}.*parquet"))


def write_shard(outputs: Path, name: str, runs: Sequence[ShardRun]) -> Path:
    """Store runs without trace in one file, and return it.

    Raises:
        StoreError: if the disk does not take it.
    """
    import pyarrow
    import pyarrow.parquet

    ends = [outcome(run) for run in runs]
    columns = {
        "run": [end.name for end in ends],
        "failure": [end.failure for end in ends],
        "cut_short": [end.cut_short for end in ends],
        "config": [json.dumps(run.config) for run in runs],
        "urdf": [run.urdf for run in runs],
        "record": [json.dumps(run.record, allow_nan=False) for run in runs],
        _CAVEATS: [end.caveats for end in ends],
    }
    kinds = {"cut_short": pyarrow.bool_(), _CAVEATS: pyarrow.int32()}
    arrays = [
        pyarrow.array(values, kinds.get(name, pyarrow.string()), from_pandas=False) for name, values in columns.items()
    ]
    table = pyarrow.Table.from_arrays(arrays, names=list(columns)).replace_schema_metadata({"schema": str(SCHEMA)})
    buffer = io.BytesIO()
    pyarrow.parquet.write_table(table, buffer, compression="zstd")
    content = buffer.getvalue()
    path = outputs / "shards" / f"{name}.{digest(content)[:_HEX]}.parquet"
    write_atomically(path, content)
    return path


def read_outcomes(path: Path) -> list[Outcome]:
    """Return how the runs of a shard ended, row by row.

    Raises:
        DamagedError: if it cannot be read, or is not as it was written.
    """
    table = _read(path, _COLUMNS[:3], _CAVEATS)
    counts = table[_CAVEATS].to_pylist() if _CAVEATS in table.column_names else [0] * len(table)
    rows = zip(*(table[name].to_pylist() for name in _COLUMNS[:3]), counts, strict=True)
    return [Outcome(*row) for row in rows]


def open_row(path: Path, row: int) -> ShardRun:
    """Open the run in a row of a shard.

    Raises:
        DamagedError: if it cannot be read, or is not as it was written.
    """
    values = _read_rows(path)
    try:
        config, record = (json.loads(values[column][row].as_py()) for column in ("config", "record"))
        fault = "" if is_sealed_shard(path) else find_faults(record)
    except (ValueError, TypeError, RecursionError) as error:
        fault = str(error)
    if fault:
        raise DamagedError(f"cannot read {path}: row {row} is no run: {fault}; {_MEND}")
    folder = path.parent.parent / "runs" / values["run"][row].as_py()
    return ShardRun(folder, config, record, values["urdf"][row].as_py(), whole=is_sealed_shard(path))


def is_sealed_shard(path: Path) -> bool:
    """Tell whether a shard's name holds a digest; those of schema 1 do not."""
    return path.name.count(".") > 1


@lru_cache(maxsize=4)  # runs are read in order, which is nearly the order of the shards
def _read_rows(path: Path) -> Any:
    return _read(path, _COLUMNS)


def _read(path: Path, columns: Sequence[str], newer: str = "") -> Any:
    """Return columns of a shard, and one that older shards lack where it is there."""
    import pyarrow
    import pyarrow.parquet

    try:
        content = path.read_bytes()
        if is_sealed_shard(path) and digest(content)[:_HEX] != path.name.split(".")[1]:
            raise DamagedError(f"cannot read {path}: it is damaged: its content has another digest than named; {_MEND}")
        file = pyarrow.parquet.ParquetFile(pyarrow.BufferReader(content))
        if not is_sealed_shard(path) and b"schema" in (file.schema_arrow.metadata or {}):
            raise DamagedError(f"cannot read {path}: its name has lost its digest; {_MEND}")
        wanted = [*columns, *(name for name in file.schema_arrow.names if name == newer)]
        table = file.read(wanted)
    except (OSError, pyarrow.ArrowException) as error:
        raise DamagedError(f"cannot read {path}: {str(error).splitlines()[0]}; {_MEND}") from error
    if table.column_names != wanted:
        raise DamagedError(f"cannot read {path}: it is no shard: it needs columns {', '.join(columns)}; {_MEND}")
    return table
