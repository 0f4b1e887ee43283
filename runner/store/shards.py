"""Shards: finished runs of large sweeps that kept no trace, some hundred to a file.

`outputs/shards/NAME.parquet` has a row for each run: its hash, what went wrong, and config, URDF and record as a run's
folder holds them. A shard is written once and whole; of two rows for one run, that of the later shard counts.
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
from runner.store.run import Run, describe_failure

_COLUMNS = ("run", "failure", "cut_short", "config", "urdf", "record")


@dataclass(frozen=True)
class Outcome:
    """How a finished run ended.

    Attributes:
        name: Its hash.
        failure: When, where and why it failed, in words; empty for a good run.
        cut_short: Whether something else than its physics ended it, as its time limit.
    """

    name: str
    failure: str
    cut_short: bool


@dataclass(frozen=True)
class ShardRun(Run):
    """A stored run without trace.

    Attributes:
        text: The URDF's text.
    """

    text: str

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
        return Outcome(run.hash, "", False)
    return Outcome(run.hash, describe_failure(failure), failure["time"] is None)


def shard_path(outputs: Path, name: str) -> Path:
    """Return the file of a shard."""
    return outputs / "shards" / f"{name}.parquet"


def write_shard(path: Path, runs: Sequence[ShardRun]) -> None:
    """Store runs without trace in one file.

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
    }
    arrays = [
        pyarrow.array(values, pyarrow.bool_() if name == "cut_short" else pyarrow.string(), from_pandas=False)
        for name, values in columns.items()
    ]
    buffer = io.BytesIO()
    pyarrow.parquet.write_table(pyarrow.Table.from_arrays(arrays, names=list(columns)), buffer, compression="zstd")
    write_atomically(path, buffer.getvalue())


class Shards:
    """The runs in the shards of an outputs folder.

    Args:
        outputs: The outputs folder; shards that are added later are not seen.

    Raises:
        StoreError: if a shard cannot be read.
    """

    def __init__(self, outputs: Path) -> None:
        self._outputs = outputs
        self._found: dict[str, tuple[Path, int, Outcome]] = {}
        for path in sorted((outputs / "shards").glob("*.parquet")):
            for row, end in enumerate(read_outcomes(path)):
                self._found[end.name] = (path, row, end)

    def outcome(self, name: str) -> Outcome | None:
        """Return how a run ended, or None when no shard has it."""
        found = self._found.get(name)
        return None if found is None else found[2]

    def open(self, name: str) -> Run | None:
        """Open a run, or return None when no shard has it.

        Raises:
            StoreError: if its shard is damaged.
        """
        if name not in self._found:
            return None
        path, row, _ = self._found[name]
        values = _read_rows(path)
        config, record = (json.loads(values[column][row].as_py()) for column in ("config", "record"))
        return ShardRun(self._outputs / "runs" / name, config, record, values["urdf"][row].as_py())


def read_outcomes(path: Path) -> list[Outcome]:
    """Return how the runs of a shard ended, row by row.

    Raises:
        StoreError: if it cannot be read.
    """
    table = _read(path, _COLUMNS[:3])
    rows = zip(*(table[name].to_pylist() for name in _COLUMNS[:3]), strict=True)
    return [Outcome(name, failure, cut_short) for name, failure, cut_short in rows]


@lru_cache(maxsize=4)  # runs are read in order, which is nearly the order of the shards
def _read_rows(path: Path) -> Any:
    return _read(path, _COLUMNS)


def _read(path: Path, columns: Sequence[str]) -> Any:
    import pyarrow
    import pyarrow.parquet

    try:
        return pyarrow.parquet.ParquetFile(path).read(list(columns))
    except (OSError, pyarrow.ArrowException) as error:
        raise StoreError(
            f"cannot read {path}: {str(error).splitlines()[0]}; remove it, and the sweep's command makes its runs again"
        ) from error
