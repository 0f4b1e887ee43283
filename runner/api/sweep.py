"""Public class of a stored sweep: axes, cells, tables and comparisons."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from runner import store
from runner.api import page
from runner.api.boundary import public, public_class
from runner.api.run import Run
from runner.base.errors import RunnerError, unknown
from runner.base.quantities import quantity
from runner.base.sanitize import few, one_line
from runner.store.axes import Axis, axes_of, find_axis
from runner.sweeps.measurements import Measurements, measure_sweep
from runner.sweeps.question import find_question
from runner.sweeps.status import Status, find_status

if TYPE_CHECKING:
    import pandas as pd

    from runner.api.comparison import Comparison

_CELLS_SHOWN, _METRICS_SHOWN = 20, 3
_LEVELS = ("cells", "repetitions")


class Sweep(store.Sweep):
    """A stored sweep: `runner.sweep` makes one, `runner.open_sweep` opens one.

    >>> sweep = runner.sweep("noise=thesis", "trajectory=quintic", duration=0.1, repetitions=6, workers=0,
    ...                      robot=["macro", "mini"], controller=["operational_space", "computed_torque"])
    >>> len(sweep)
    4
    >>> sweep.to_frame(["max_tracking_error"])[["robot", "controller", "median", "low", "high", "n"]].shape
    (4, 6)
    >>> paired = sweep.compare(by="controller", within="robot", metrics=["max_tracking_error"])
    >>> paired[["robot", "first", "second", "difference", "low", "high", "n"]].shape
    (2, 7)
    >>> sweep.run(robot="mini", controller="computed_torque").status
    'ok'
    """

    @property
    def axes(self) -> Mapping[str, Sequence[float] | Sequence[str]]:
        """Swept keys and their values."""
        return {axis.name: axis.values for axis in self._axes}

    def __len__(self) -> int:
        """Return the number of cells, the combinations of the values."""
        return len(self.hashes)

    def runs(self) -> Iterator[Run]:
        """Open the runs one after the other, in the order of the cells.

        Raises:
            RunnerError: if a run is missing or damaged.
        """
        return (public_class(Run, run) for run in super().runs())

    @public
    def run(self, **values: object) -> Run:
        """Return the one run with some values of the axes; two underscores in a keyword stand for a dot.

        Raises:
            RunnerError: if there is no such axis, value or run, or more than one run; names the axes that need a value.
        """
        chosen = np.ones(len(self), dtype=bool)
        for name, value in values.items():
            axis = find_axis(self._axes, name.replace("__", "."))
            chosen &= axis.level == axis.find_level(value)
        cells = np.flatnonzero(chosen)
        if len({self.hashes[cell] for cell in cells.tolist()}) > 1:
            others = [axis for axis in self._axes if len(np.unique(axis.level[cells])) > 1]
            left = "; ".join(f"{axis.name}: {few(axis.texts)}" for axis in others)
            raise RunnerError(f"{len(cells)} runs have these values; name one value of {left}")
        if not len(cells):
            raise RunnerError("no run of the sweep has these values together")
        return public_class(Run, store.Finished(self.outputs).open(self.hashes[int(cells[0])]))

    @public
    def to_frame(
        self, metrics: str | Sequence[str] | None = None, level: Literal["cells", "repetitions"] = "cells"
    ) -> "pd.DataFrame":
        """Return the metrics: one row for each cell and metric, or for each repetition of a cell and metric.

        The first columns are the axes under their keys. For cells then come metric and unit; median; low and high, the
        ends of the median's 95 % interval over the repetitions, missing if these are too few; n, the number of
        repetitions that have a value; status and the number of caveats. `runner table` writes one row for each cell,
        with quantiles. For repetitions then come repetition, metric, unit and value. The value is infinite if the
        repetition failed or never settled.

        Args:
            metrics: Names of metrics; None for all.
            level: Meaning of a row: "cells" or "repetitions".

        Raises:
            RunnerError: if there is no such metric or level, or if runs are missing.
        """
        if level not in _LEVELS:
            raise RunnerError(unknown("name", level, _LEVELS, "level"))
        names = self._names(metrics)
        return self._cell_frame(names) if level == "cells" else self._repetition_frame(names)

    def _cell_frame(self, names: Sequence[str]) -> "pd.DataFrame":
        import pandas as pd

        from runner.sweeps.table import table

        found = self._measurements
        wide = table(found, names)
        keys = [axis.name for axis in found.axes]
        parts = []
        for name in names:
            part = wide[keys].copy()
            part["metric"], part["unit"] = name, found.units[name]
            for column in ("median", "low", "high", "n"):
                part[column] = wide[f"{name}.{column}"]
            part["status"], part["caveats"] = wide["status"], wide["caveats"]
            parts.append(part)
        return pd.concat(parts, ignore_index=True) if parts else wide[[*keys, "status", "caveats"]]

    def _repetition_frame(self, names: Sequence[str]) -> "pd.DataFrame":
        import pandas as pd

        found = self._measurements
        parts = []
        for name in names:
            cells, repetitions = np.nonzero(~np.isnan(found.values[name]))
            values = {"repetition": repetitions, "metric": name, "unit": found.units[name],
                      "value": found.values[name][cells, repetitions]}  # fmt: skip
            parts.append(pd.DataFrame(found.axis_columns(cells) | values))
        keys = [axis.name for axis in found.axes]
        none = pd.DataFrame(columns=[*keys, "repetition", "metric", "unit", "value"])
        return pd.concat(parts, ignore_index=True) if parts else none

    @public
    def compare(
        self,
        *,
        by: str | None = None,
        within: str | Sequence[str] | None = None,
        metrics: str | Sequence[str] | None = None,
    ) -> "Comparison":
        """Compare the values of an axis with each other, in pairs of runs that differ in nothing else.

        The columns are the axes in `within`, "all" if compared over all their values; first and second, the two values;
        metric and unit; difference, second minus first (Hodges-Lehmann); low and high, the ends of its interval; n, the
        number of pairs; effect, from -1 (smaller in every pair) to 1; p, corrected (Holm); and word, the conclusion.
        The interval excludes zero exactly if p is below 0.05. Without draws the difference is exact. A pooled row is
        left out if its conditions disagree. The attribute `summary` has the answers in words.

        Args:
            by: The axis; None for the question of the sweep, such as "controller".
            within: Axes; the comparison is repeated for each combination of their values. None compares over all other
                axes, and under each combination of their values.
            metrics: Names of metrics; None for all.

        Raises:
            RunnerError: if there is no such axis or metric, no question, or no two runs share their seeds.
        """
        from runner.api.comparison import comparison
        from runner.reporting.comparison.sweeps import compare_levels
        from runner.sweeps.finer_step import work_out_sweep

        names = self._names(metrics)  # raises an error if runs are missing
        work_out_sweep(self)
        self.__dict__.pop("_measurements", None)  # measured before the finer step was simulated
        inside = [within] if isinstance(within, str) else within
        asked = by or getattr(find_question(self._axes, self.question), "name", "")
        if not asked:
            raise RunnerError(f"by: all axes are conditions. Allowed: {', '.join(axis.name for axis in self._axes)}.")
        return comparison(compare_levels(self._measurements, asked, inside, names if metrics else ()), [self.folder])

    @public
    def repetitions_needed(self, share: float) -> "pd.DataFrame":
        """Return the repetitions that show a difference with a probability of 80 %, as `--detect` counts them.

        This sweep is the pilot. Each row is a metric, under the condition that needs most repetitions. The columns are
        metric; at, that condition; repetitions; low and high, those of the 95 % interval of the scatter; and reason,
        what the number follows from or why there is none.

        Args:
            share: The difference, as a share of the larger median, above 0.02.

        Raises:
            RunnerError: if the share is not above 0.02 and at most 1, or runs are missing.
        """
        import pandas as pd

        from runner.reporting.sweep.detect import check_share, count_differences
        from runner.reporting.sweep.subject import choose
        from runner.sweeps.finer_step import work_out_sweep

        check_share(share)
        work_out_sweep(self)
        found = count_differences(choose(measure_sweep(self)), share)
        rows = [[one.metric, one.place, one.repetitions, *(one.ends or (None, None)), one.reason] for one in found]
        return pd.DataFrame(rows, columns=["metric", "at", "repetitions", "low", "high", "reason"])

    def __repr__(self) -> str:
        told = _progress_text(find_status(self))
        return "\n  ".join(map(one_line, [f"Sweep of {len(self)} runs: {told}", *self._over(), str(self.folder)]))

    def _repr_html_(self) -> str:
        status = find_status(self)
        parts = [
            page.heading("Sweep", f"{len(self)} runs: {_progress_text(status)}"),
            page.listed("Swept over", self._over()),
        ]
        parts += [] if status.left else [self._cells()]
        return "".join([*parts, page.code(self.folder)])

    def _cells(self) -> str:
        """Return a table of the first cells, with the medians of the metrics that the report of the sweep compares."""
        from runner.reporting.metric_titles import title
        from runner.reporting.sweep.subject import choose

        runs = self._measurements
        subject = choose(runs)
        names = subject.metrics[:_METRICS_SHOWN]
        rows = [
            [
                *(axis.text(int(axis.level[cell])) for axis in runs.axes),
                *(quantity(float(subject.medians[name][cell]), runs.units[name]) for name in names),
                runs.statuses[cell],
                len(runs.caveats[cell]),
            ]
            for cell in range(min(len(self), _CELLS_SHOWN))
        ]
        heads = [*(axis.name for axis in runs.axes), *(f"{title(name)}, median" for name in names)]
        more = len(self) - len(rows)
        rest = f"and {more} more; `to_frame()` has all of them" if more else ""
        return page.table([*heads, "status", "caveats"], rows) + page.line(rest)

    def _over(self) -> list[str]:
        return [f"{axis.name}: {few(axis.texts)}" for axis in self._axes]

    def _names(self, metrics: str | Sequence[str] | None) -> Sequence[str]:
        return self._measurements.named([metrics] if isinstance(metrics, str) else metrics)

    @cached_property
    def _axes(self) -> Sequence[Axis]:
        return axes_of(self.overrides)[0]

    @cached_property
    def _measurements(self) -> Measurements:
        """Cells with their values; an incomplete sweep is read again each time."""
        return measure_sweep(self)


def _progress_text(status: Status) -> str:
    """Return the progress of a sweep as a message."""
    texts = [f"{status.left} not made yet" if status.left else "all made"]
    texts += [f"{status.failed} failed"] if status.failed else []
    doubted = sum(map(bool, status.caveats))
    return ", ".join(texts + ([f"{doubted} with caveats"] if doubted else []))
