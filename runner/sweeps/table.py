"""A sweep as one tidy table, a row for each cell: Parquet and CSV, readable with pandas alone."""

import io
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runner.statistics import SMALLEST_SAMPLE, median_intervals
from runner.store.atomic import write_atomically
from runner.sweeps.measurements import FloatArray, Measurements
from runner.texts import table_cell

if TYPE_CHECKING:
    import pandas as pd

QUANTILES = (0.05, 0.25, 0.75, 0.95)


def table(measurements: Measurements) -> "pd.DataFrame":
    """Return the table of a sweep.

    The columns are the swept axes under their keys; status, failure and hash; the number of caveats, and the
    rules that were sprung; and of every metric `NAME.median`;
    `NAME.low` and `.high`, the ends of the median's 95 % interval by the bootstrap, missing where the repetitions are
    too few; `NAME.q05`, `.q25`, `.q75`, `.q95`; and `NAME.n`, the number of repetitions that have a value. A repetition
    without one counts as beyond every number; what is itself beyond every number is missing. A quantile is the
    smallest value that so large a share of the repetitions does not exceed, never a value between two of them: NumPy's
    inverted_cdf. The median of an even number is the mean of the two in the middle.
    """
    import pandas as pd

    columns: dict[str, object] = {axis.name: [axis.values[level] for level in axis.level] for axis in measurements.axes}
    columns |= {
        "status": list(measurements.statuses),
        "failure": list(measurements.failures),
        "hash": list(measurements.hashes),
    }
    caveats = measurements.caveats or [()] * len(measurements.hashes)
    columns["caveats"] = [len(found) for found in caveats]
    columns["caveats.rules"] = [" ".join(str(caveat["rule"]) for caveat in found) for found in caveats]
    for name in measurements.values:
        columns |= dict(_columns(measurements, name))
    return pd.DataFrame(columns)


def write_table(measurements: Measurements, folder: Path) -> "pd.DataFrame":
    """Write `table.parquet`, with the unit of each column in its metadata, and `table.csv`; return the table.

    Raises:
        StoreError: If the disk does not take them.
    """
    import pyarrow
    import pyarrow.parquet

    frame = table(measurements)
    arrow = pyarrow.Table.from_pandas(frame, preserve_index=False)
    schema = arrow.schema
    for index, column in enumerate(frame.columns):
        name, _, kind = str(column).rpartition(".")
        unit = measurements.units.get(name)
        if unit is not None and kind != "n":
            schema = schema.set(index, schema.field(index).with_metadata({"unit": unit}))
    buffer = io.BytesIO()
    pyarrow.parquet.write_table(arrow.cast(schema), buffer, compression="zstd")
    write_atomically(folder / "table.parquet", buffer.getvalue())
    texts = frame.select_dtypes(exclude="number").columns
    safe = frame.assign(**{name: frame[name].map(table_cell) for name in texts}).rename(columns=table_cell)
    write_atomically(folder / "table.csv", safe.to_csv(index=False).encode())
    return frame


def _columns(measurements: Measurements, name: str) -> Iterator[tuple[str, FloatArray]]:
    """Yield the columns of one metric, each of shape (cells,)."""
    ordered = np.sort(measurements.values[name], axis=1)  # NaN, which is no repetition, comes last
    count = np.sum(~np.isnan(ordered), axis=1)
    yield f"{name}.median", _finite(measurements.medians(name))
    low, high = np.full((2, len(ordered)), np.nan)
    for n in np.unique(count[count >= SMALLEST_SAMPLE]).tolist():
        cells = np.flatnonzero(count == n)
        low[cells], high[cells] = median_intervals(ordered[cells, :n])
    yield f"{name}.low", _finite(low)
    yield f"{name}.high", _finite(high)
    for share in QUANTILES:
        place = np.array([max(math.ceil(share * n - 1e-9) - 1, 0) for n in count.tolist()], dtype=np.intp)
        yield f"{name}.q{round(100 * share):02d}", _finite(ordered[np.arange(len(ordered)), place])
    yield f"{name}.n", np.sum(np.isfinite(ordered), axis=1)


def _finite(values: FloatArray) -> FloatArray:
    """Return the values with those beyond every number as missing."""
    found: FloatArray = np.where(np.isfinite(values), values, np.nan)
    return found
