"""Tables of pooled cells: rows of cells that differ only in the seed, as CSV or Parquet in SI units."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.sanitize import csv_text
from runner.store.axes import Axis, find_axis, find_cells, group_cells
from runner.sweeps.measurements import Measurements
from runner.sweeps.table import metric_columns, with_units

if TYPE_CHECKING:
    import pandas as pd

SEED = "seed"


@dataclass(frozen=True)
class Pooled:
    """The rows of a table.

    Attributes:
        measurements: A sweep with one cell for each row, whose repetitions are those of all its cells.
        cells: The cells of the whole sweep behind each row.
        failed: Number of these that failed.
        seeds: Number of seeds behind each row; 1 if the seed was not swept.
    """

    measurements: Measurements
    cells: Sequence[NDArray[np.intp]]
    failed: Sequence[int]
    seeds: Sequence[int]


def pool(measurements: Measurements, by: Sequence[str] | None = None, where: Sequence[str] = ()) -> Pooled:
    """Put the cells of a sweep together that have the same values on some axes, and differ only in the seed.

    Args:
        measurements: The sweep.
        by: The axes whose levels make the rows; None takes all swept axes but the seed.
        where: Values to which cells are limited, each as KEY=VALUE.

    Raises:
        RunnerError: If there is no such axis or value, or cells of one row would differ in more than their seed.
    """
    kept = find_cells(measurements.axes, where, len(measurements.hashes))
    axes = {axis.name: axis for axis in measurements.axes}
    varying = [axis.name for axis in measurements.axes if len(np.unique(axis.level[kept])) > 1]
    names = [name for name in varying if name != SEED] if by is None else list(dict.fromkeys(by))
    for name in names:
        find_axis(measurements.axes, name, "--by")
    _refuse_mixtures([name for name in varying if name not in names and name != SEED], names, axes, kept)
    rows = group_cells([axes[name] for name in names], kept)
    levels = np.array([levels for levels, _ in rows], dtype=np.intp)
    groups = [_distinct(measurements, cells) for _, cells in rows]
    failed = [sum(measurements.statuses[cell] != "ok" for cell in cells) for cells in groups]
    pooled = replace(
        measurements,
        axes=[Axis(name, axes[name].values, levels[:, column]) for column, name in enumerate(names)],
        fixed=[*measurements.fixed, *where],
        hashes=[measurements.hashes[cells[0]] if len(cells) == 1 else "" for cells in groups],
        statuses=["failed" if count else "ok" for count in failed],
        failures=[next((measurements.failures[cell] for cell in cells if measurements.failures[cell]), "")
                  for cells in groups],
        values={name: _together(values, groups) for name, values in measurements.values.items()},
        caveats=[[caveat for cell in cells for caveat in measurements.caveats[cell]] for cells in groups]
        if measurements.caveats else (),
        seeds=(),
    )  # fmt: skip
    seeds = [len(np.unique(axes[SEED].level[cells])) if SEED in axes else 1 for cells in groups]
    return Pooled(pooled, groups, failed, seeds)


def _refuse_mixtures(
    others: Sequence[str], names: Sequence[str], axes: Mapping[str, Axis], kept: NDArray[np.intp]
) -> None:
    if not others:
        return
    values = " ".join(f"--where {name}={axes[name].text(int(axes[name].level[kept[0]]))}" for name in others)
    raise RunnerError(
        f"a row would mix cells that differ in {', '.join(others)}; only seeds are put together: write "
        f"--by {','.join([*names, *others])} for a row each, or fix a value, as in {values}"
    )


def _distinct(measurements: Measurements, cells: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the cells without those that a run before them stands for already."""
    first: dict[str, int] = {}
    for cell in cells.tolist():
        first.setdefault(measurements.hashes[cell], cell)
    return np.array(list(first.values()), dtype=np.intp)


def _together(values: FloatArray, groups: Sequence[NDArray[np.intp]]) -> FloatArray:
    """Return the values of the cells of each group in one row, NaN behind them, shape (groups, most values)."""
    rows = [values[cells].ravel() for cells in groups]
    found = np.full((len(rows), max(map(len, rows), default=0)), np.nan)
    for row, own in enumerate(rows):
        found[row, : len(own)] = own
    return found


def selection(
    measurements: Measurements,
    metrics: Sequence[str] | None = None,
    by: Sequence[str] | None = None,
    where: Sequence[str] = (),
) -> "pd.DataFrame":
    """Return a row for each combination of some axes: their values, its number of cells, and the metrics.

    The columns of a metric are those of `runner.sweeps.table`; see `pool` for the arguments and errors.
    """
    import pandas as pd

    pooled = pool(measurements, by, where)
    rows = pooled.measurements
    counts = {"cells": [len(cells) for cells in pooled.cells], "failed": pooled.failed}
    return pd.DataFrame(rows.axis_columns() | counts | metric_columns(rows, metrics))


def of_one(measurements: Measurements, metrics: Sequence[str] | None = None) -> "pd.DataFrame":
    """Return the table of one run: a row for each metric, with its unit."""
    import pandas as pd

    rows = []
    for name in measurements.named(metrics):
        found = metric_columns(measurements, [name])
        rows.append({"metric": name, "unit": measurements.units[name]}
                    | {key.removeprefix(f"{name}."): column[0] for key, column in found.items()})  # fmt: skip
    return pd.DataFrame(rows)


def as_csv(frame: "pd.DataFrame") -> bytes:
    """Return a table as CSV whose cells no spreadsheet reads as formulas."""
    return csv_text([frame.columns, *frame.itertuples(index=False)]).encode()


def as_parquet(frame: "pd.DataFrame", measurements: Measurements) -> bytes:
    """Return a table as Parquet, with the unit of each column of a metric in its metadata."""
    import pyarrow
    import pyarrow.parquet

    content = pyarrow.Table.from_pandas(frame, preserve_index=False)
    stream = io.BytesIO()
    pyarrow.parquet.write_table(
        content.cast(with_units(content.schema, measurements.units)), stream, compression="zstd"
    )
    return stream.getvalue()
