"""Reading a stored run."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.errors import StoreError
from runner.store.stored import Stored, read_job

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = 1
_NEEDED = {"schema": int, "status": str, "metrics": dict, "provenance": dict, "repetitions": int}


@dataclass(frozen=True)
class Run(Stored):
    """A stored run; its record is the content of metrics.json."""

    def made_by(self, command: str) -> "Run":
        """Return this run with another command that makes it, as equal configs can be reached in several ways."""
        return replace(self, record={**self.record, "provenance": {**self.provenance, "command": command}})

    @property
    def status(self) -> str:
        """Either "ok" or "failed"."""
        return str(self.record["status"])

    @property
    def failure(self) -> Mapping[str, Any] | None:
        """Reason, time, joint and repetition of a failed run; all but the reason None where it was cut short."""
        failure: Mapping[str, Any] | None = self.record.get("failure")
        return failure

    @property
    def failure_text(self) -> str:
        """When, where and why a failed run failed, in words; empty for a good one."""
        return "" if self.failure is None else describe_failure(self.failure)

    @property
    def metrics(self) -> Mapping[str, Mapping[str, Any]]:
        """Metrics by name: unit, median, min, max and values of each repetition."""
        metrics: Mapping[str, Mapping[str, Any]] = self.record["metrics"]
        return metrics

    @cached_property
    def trace(self) -> "pd.DataFrame":
        """Signals of repetition 0, a row per tick; `units` tells the columns' units.

        Raises:
            StoreError: if the file is missing or damaged.
        """
        frame: pd.DataFrame = self._table.to_pandas()
        return frame

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column of the trace."""
        return {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in self._table.schema}

    @cached_property
    def _table(self) -> Any:
        import pyarrow
        import pyarrow.parquet

        path = self.folder / "trace.parquet"
        try:
            return pyarrow.parquet.ParquetFile(path).read()  # read_table would import pandas, half a second
        except (OSError, pyarrow.ArrowException) as error:
            raise StoreError(f"cannot read {path}: {str(error).splitlines()[0]}; run it again to mend it") from error


def describe_failure(failure: Mapping[str, Any]) -> str:
    """Return when, where and why a run failed, in words.

    Args:
        failure: Reason, time, joint and repetition, as stored.
    """
    repetition, time, joint, reason = (failure[key] for key in ("repetition", "time", "joint", "reason"))
    if time is None:
        return f"cut short: {reason}"
    where = f" ({joint})" if joint else ""
    return f"failed in repetition {repetition} at t = {time:.4g} s{where}: {reason}"


def is_run(folder: Path) -> bool:
    """Tell whether a folder looks like a run's, finished or not."""
    return any((folder / name).exists() for name in ("metrics.json", "config.yaml", "trace.parquet"))


def open_run(folder: Path) -> Run:
    """Open a finished run.

    Raises:
        StoreError: if the folder is no run, or one that was not finished, or is damaged.
    """
    if not folder.is_dir():
        raise StoreError(f"no folder {folder}")
    record_path = folder / "metrics.json"
    if not record_path.exists():
        what = "a run that did not finish" if is_run(folder) else "no stored run"
        what = "a sweep, not a single run" if (folder / "sweep.json").exists() else what
        raise StoreError(
            f"{folder} is {what}: it has no metrics.json; `runner OVERRIDES` makes a run and prints its folder"
        )
    record, config = read_job(folder, "metrics.json", "run")
    if not isinstance(config, dict):
        raise StoreError(f"{folder / 'config.yaml'} holds no config")
    if isinstance(record, dict) and record.get("schema", SCHEMA) != SCHEMA:
        raise StoreError(f"{record_path} has schema {record['schema']!r}; this version reads {SCHEMA}")
    if not _is_record(record):
        raise StoreError(
            f"{record_path} is no metrics file: it needs {', '.join(sorted(_NEEDED))}, as a run writes them"
        )
    return Run(folder, config, record)


def _is_record(record: Any) -> bool:
    return (
        isinstance(record, dict)
        and all(isinstance(record.get(key), kind) for key, kind in _NEEDED.items())
        and all(isinstance(metric, dict) and {"unit", "median"} <= set(metric) for metric in record["metrics"].values())
        and (record["status"] == "ok" or isinstance(record.get("failure"), dict))
    )
