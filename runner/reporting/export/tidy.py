"""Tidy table of a sweep or run in SI units, as CSV or Parquet."""

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

from runner.base.sanitize import table_cell
from runner.reporting.export.pooling import failed_cells, pool
from runner.sweeps.measurements import Measurements
from runner.sweeps.table import metric_columns, with_units

if TYPE_CHECKING:
    import pandas as pd


def selection(
    measurements: Measurements,
    metrics: Sequence[str] | None = None,
    by: Sequence[str] | None = None,
    where: Sequence[str] = (),
) -> "pd.DataFrame":
    """Return a row for each combination of some axes: their values, how many cells stand behind it, and the metrics.

    The columns of a metric are those of `runner.sweeps.table`; see `pool` for the arguments and errors.
    """
    import pandas as pd

    pooled = pool(measurements, by, where)
    rows = pooled.measurements
    columns: dict[str, object] = {
        axis.name: [axis.values[level] for level in axis.level.tolist()] for axis in rows.axes
    }
    columns["cells"] = [len(cells) for cells in pooled.cells]
    columns["failed"] = failed_cells(measurements, pooled)
    return pd.DataFrame(columns | metric_columns(rows, metrics))


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
    """Return a table as CSV of which no cell is taken for a formula."""
    texts = frame.select_dtypes(exclude="number").columns
    safe = frame.assign(**{name: frame[name].map(lambda value: table_cell(str(value))) for name in texts})
    return safe.rename(columns=table_cell).to_csv(index=False, lineterminator="\n").encode()


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
