"""Stored run and its reader."""

import itertools
import re
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, StoreError, nearest
from runner.config.composed import Composed
from runner.store.drawn import draws_nothing
from runner.store.kinds import kind_of
from runner.store.parquet import VALUES_FILE, numbers, open_parquet, read_column, read_table
from runner.store.record import Metrics, find_config_faults, find_faults
from runner.store.seal import MEND, DamagedError, Stored, read_job, write_job

if TYPE_CHECKING:
    import pandas as pd

    from runner.robots.model import RobotModel
    from runner.schema.bound import Bound
    from runner.statistics.spec import Histories, Spec

_QUOTES = re.compile(r"""["'\\]|[^ -~]""")  # without these, words end at spaces


@dataclass(frozen=True, eq=False)
class Run(Stored):
    """A stored run; its record is the content of metrics.json.

    Attributes:
        text: URDF of a run without a trace, which is stored in a shard; None for a run in its own folder.
        beside: Function that reads the values of a metric of such a run, if its record does not list them.
    """

    text: str | None = None
    beside: Callable[[str], FloatArray] | None = None

    @cached_property
    def urdf(self) -> str:
        """Simulated URDF.

        Raises:
            DamagedError: if the file is missing or damaged.
        """
        return super().urdf if self.text is None else self.text

    def made_by(self, command: str) -> "Run":
        """Return this run with another command: several commands can give equal configs."""
        return replace(self, record={**self.record, "provenance": {**self.provenance, "command": command}})

    @property
    def status(self) -> str:
        """Either "ok" or "failed"."""
        return str(self.record["status"])

    @property
    def repetitions(self) -> int:
        """Number of repetitions, each with other random draws."""
        return int(self.record["repetitions"])

    @property
    def failure_record(self) -> Mapping[str, Any] | None:
        """Reason, time, joint and repetition of a failed run; only the reason of an aborted run."""
        failure: Mapping[str, Any] | None = self.record.get("failure")
        return failure

    @property
    def failure(self) -> str | None:
        """Message with the time, location and reason of the failure; None for a good run."""
        return None if self.failure_record is None else describe_failure(self.failure_record)

    @property
    def config_dirs(self) -> Sequence[Path]:
        """Config folders in the command of the run, which are searched for the robot file."""
        return [Path(after) for before, after in itertools.pairwise(self._words) if before == "--config-dir"]

    @property
    def composed(self) -> Composed:
        """Composed config, to be checked again."""
        return Composed(self.config, tuple(self.overrides), {}, tuple(self.config_dirs))

    @property
    def overrides(self) -> Sequence[str]:
        """Overrides in the command of the run."""
        pairs = itertools.pairwise(self._words)
        return [after for before, after in pairs if "--" not in (before[:2], after[:2])]

    @cached_property
    def _words(self) -> Sequence[str]:
        command = str(self.provenance["command"])
        return shlex.split(command) if _QUOTES.search(command) else command.split()  # the latter takes a tenth

    @property
    def metrics(self) -> Metrics:
        """Metrics by name, each a Metric with unit, median, min, max and values."""
        return Metrics(self.record, self.values)

    def values(self, metric: str) -> FloatArray:
        """Return a metric in each repetition, shape (repetitions,), NaN if it has no value.

        Args:
            metric: Name of a metric of the run.

        Raises:
            KeyError: if the run has no such metric.
            DamagedError: if the values are in a separate file, and that file is missing or damaged.
        """
        stored = self.record["metrics"][metric].get("values")
        if stored is not None:
            return np.array(stored, dtype=np.float64)  # None is NaN
        return self.beside(metric) if self.beside else read_column(self._values_file, self.folder / VALUES_FILE, metric)

    @cached_property
    def _values_file(self) -> Any:
        return open_parquet(self.read(VALUES_FILE), self.folder / VALUES_FILE)

    @property
    def caveats(self) -> Sequence[Mapping[str, Any]]:
        """Caveats, reasons why the metrics may mislead: rule, text, value and number of repetitions of each."""
        caveats: Sequence[Mapping[str, Any]] = self.record["caveats"]
        return caveats

    @property
    def plant_error(self) -> Mapping[str, Any] | None:
        """Integration error of the plant in repetition 0 (docs/stored_runs.md); None if it was not requested."""
        error: Mapping[str, Any] | None = self.record.get("plant_error")
        return error

    @property
    def rounding(self) -> Mapping[str, Any] | None:
        """Growth of rounding errors in repetition 0 (docs/stored_runs.md); None if it was not requested."""
        growth: Mapping[str, Any] | None = self.record.get("rounding")
        return growth

    @property
    def caveat_rules(self) -> Mapping[str, Any] | None:
        """Digest and thresholds of the rules that found the caveats; None for an aborted run."""
        rules: Mapping[str, Any] | None = self.record.get("caveat_rules")
        return rules

    @cached_property
    def spec(self) -> "Spec | None":
        """Bounds on the metrics, number of repetitions that meet them, and failure probability, `failing`.

        None for a run without bounds.
        """
        from runner.statistics.spec import read_spec

        stored = self.record.get("spec")
        return None if stored is None else read_spec(stored)

    def judged_by(self, bounds: "Mapping[str, Bound]", later: "Histories") -> "Run":
        """Return this run evaluated against other bounds on its metrics.

        Args:
            bounds: The bounds, one or more.
            later: Dates on which bounds were set; the run's original bounds were set before.
        """
        from runner.statistics.spec import bounds_of, judge, merge_histories, settings

        exact = draws_nothing(self.config)
        spec = judge(bounds, self.record["repetitions"], self.record["metrics"], self.values, exact)
        made_with = settings({**dict.fromkeys(later), **bounds_of(self.config)}, self.provenance["date"])
        history = merge_histories(made_with, self.record.get("spec", {}).get("history", {}), later)
        return replace(self, record={**self.record, "spec": {**spec.record(), "history": history}})

    def trace(self) -> "pd.DataFrame":
        """Return the signals of repetition 0, one row per tick; `units` has the units of the columns.

        Changes to the returned table do not affect later calls.

        Raises:
            DamagedError: if the file is missing or damaged.
            StoreError: if the run has no trace.
        """
        frame: pd.DataFrame = self._table.to_pandas(use_threads=False)
        return frame

    @property
    def t(self) -> FloatArray:
        """Times of the trace's rows, shape (T,), in s."""
        return self.signal("t")

    def signal(self, column: str) -> FloatArray:
        """Return a column of the trace, shape (T,).

        Raises:
            RunnerError: if the trace has no such column.
        """
        if column not in (known := self._table.column_names):
            raise RunnerError(f"run {self.hash} has no signal '{column}'{nearest(column, known)}")
        return numbers(self._table[column])

    def joints(self, signal: str = "q") -> FloatArray:
        """Return a signal of each joint in the trace, shape (T, nq): the columns signal1, signal2 and so on."""
        names = [name for name in self._table.column_names if name.startswith(signal) and name[len(signal) :].isdigit()]
        return np.array([self.signal(name) for name in names]).reshape(len(names), self._table.num_rows).T

    def vector(self, signal: str) -> FloatArray:
        """Return a vector in the trace, shape (T, 3): the columns signal_x, signal_y and signal_z."""
        return np.stack([self.signal(f"{signal}_{axis}") for axis in "xyz"]).T

    def median(self, metric: str) -> float | None:
        """Return the median of a metric; None if the run failed or the metric has no value.

        Raises:
            RunnerError: if the run has metrics, but none of that name.
        """
        if self.metrics and metric not in self.metrics:
            raise RunnerError(f"run {self.hash} has no metric '{metric}'{nearest(metric, self.metrics)}")
        return self.metrics[metric].median if self.metrics else None

    @cached_property
    def model(self) -> "RobotModel":
        """Rigid-body model of the simulated robot."""
        from runner.robots.model import RobotModel

        return RobotModel(self.urdf, self.provenance["tip_frame"], self.config["gravity"])

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column of the trace."""
        return units_of(self._table)

    @cached_property
    def _table(self) -> Any:
        if self.text is not None:
            command = self.provenance["command"]
            raise StoreError(
                f"run {self.hash} kept no trace (sweep.trace); this simulates it again with one: {command}"
            )
        path = self.folder / "trace.parquet"
        return read_table(open_parquet(self.read(path.name), path), path)


def units_of(table: Any) -> dict[str, str]:
    """Return the unit of each column of a trace, an Arrow table."""
    return {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in table.schema}


def describe_failure(failure: Mapping[str, Any]) -> str:
    """Return a message with the time, location and reason of a failure.

    Args:
        failure: Reason, time, joint and repetition, as stored.
    """
    repetition, time, joint, reason = (failure[key] for key in ("repetition", "time", "joint", "reason"))
    if time is None:
        return f"cut short: {reason}"
    where = f" ({joint})" if joint else ""
    return f"failed in repetition {repetition} at t = {time:.4g} s{where}: {reason}"


def open_run(folder: Path) -> Run:
    """Open a finished run.

    Raises:
        StoreError: if the folder is not a run, or the run is unfinished.
        DamagedError: if the run is damaged.
    """
    if not folder.is_dir():
        raise StoreError(f"no folder {folder}")
    if not (folder / "metrics.json").exists():
        found = {"run": "a run that did not finish", "sweep": "a sweep, not a single run"}
        what = found.get("sweep" if kind_of(folder) == "tuning" else kind_of(folder) or "", "not a stored run")
        raise StoreError(
            f"{folder} is {what}: it has no metrics.json; `runner OVERRIDES` simulates a run and prints its folder"
        )
    record, config = read_job(folder, "metrics.json")
    for name, what, faults in (
        ("metrics.json", "record", find_faults(record)),
        ("config.yaml", "config", find_config_faults(config)),
    ):
        if faults:
            raise DamagedError(f"cannot read {folder / name}: it is not a run's {what}: {faults}; {MEND}")
    return Run(folder, config, record)


def judge_run(run: Run, bounds: "Mapping[str, Bound]", date: str = "") -> Run:
    """Evaluate a run against bounds, and return it; store and report changed counts.

    Nothing is simulated: the counts follow from the stored values. Without bounds the run is unchanged. The date on
    which each bound was first set is also stored.

    Args:
        run: The run.
        bounds: The bounds.
        date: The date on which they are set; empty for today.

    Raises:
        StoreError: if they cannot be written.
    """
    from runner.base.machine import today
    from runner.statistics.spec import settings

    before = run.spec
    if not bounds or (before is not None and before.config == bounds):
        return run
    found = run.judged_by(bounds, settings(bounds, date or today()))
    write_job(run.folder, "metrics.json", {key: value for key, value in found.record.items() if key != "schema"}, {})
    what = "without a spec" if before is None else "with another spec"
    print(f"runner: stored before {what}; the shares are computed from its stored values", file=sys.stderr)
    return found
