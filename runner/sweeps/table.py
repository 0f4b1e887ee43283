"""Tidy table of a sweep with a row for each cell, as Parquet and CSV files for pandas."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.atomic import open_atomically
from runner.base.sanitize import table_cell
from runner.sweeps.measurements import Measurements, medians

if TYPE_CHECKING:
    import pandas as pd

_ROWS = 50_000  # rows in memory at a time
_TEXTS = ["status", "failure", "caveats.rules"]  # columns with many equal rows
QUANTILES = (0.05, 0.25, 0.75, 0.95)


def table(
    measurements: Measurements, metrics: Sequence[str] | None = None, rows: slice = slice(None)
) -> "pd.DataFrame":
    """Return the table of a sweep, or some of its metrics or rows.

    The first columns are the swept axes under their keys; status, failure and hash; the number of caveats, and the
    triggered rules. Each metric has these columns:

    - `NAME.median`: the median; for an even number of values, the mean of the two in the middle.
    - `NAME.low` and `.high`: the ends of the median's 95 % bootstrap interval; missing for too few repetitions.
    - `NAME.q05`, `.q25`, `.q75` and `.q95`: quantiles by NumPy's inverted_cdf, each the value of a repetition: the
      smallest value that this fraction of the repetitions does not exceed.
    - `NAME.n`: the number of repetitions that have a value.

    A repetition without a value counts as beyond every number. A result beyond every number is missing in the table.

    Args:
        measurements: The cells.
        metrics: Names of the metrics, in order; None for all metrics.
        rows: Slice of the cells.

    Raises:
        RunnerError: If the sweep lacks a metric.
    """
    import pandas as pd

    columns = measurements.axis_columns(rows) | {
        "status": list(measurements.statuses[rows]),
        "failure": list(measurements.failures[rows]),
        "hash": list(measurements.hashes[rows]),
    }
    caveats = measurements.caveats[rows] or [()] * len(measurements.hashes[rows])
    columns["caveats"] = [len(found) for found in caveats]
    columns["caveats.rules"] = [" ".join(str(caveat["rule"]) for caveat in found) for found in caveats]
    return pd.DataFrame(columns | metric_columns(measurements, metrics, rows))


def metric_columns(
    measurements: Measurements, metrics: Sequence[str] | None = None, rows: slice = slice(None)
) -> dict[str, FloatArray]:
    """Return only the columns of the metrics, each of shape (cells,); see `table`."""
    names = measurements.named(metrics)
    return {key: column for name in names for key, column in _columns(name, measurements.values[name][rows])}


def write_table(measurements: Measurements, folder: Path) -> int:
    """Write `table.parquet`, with the unit of each column in its metadata, and `table.csv`, in blocks of rows.

    Returns:
        The number of columns.

    Raises:
        StoreError: If the files cannot be written.
    """
    import pyarrow.csv
    import pyarrow.parquet

    schema = with_units(pyarrow.Table.from_pandas(table(measurements, rows=slice(0, 1))).schema, measurements.units)
    named = pyarrow.schema([field.with_name(table_cell(field.name)) for field in schema])
    unquoted = pyarrow.csv.WriteOptions(quoting_style="needed")
    with (
        open_atomically(folder / "table.parquet") as parquet_file,
        open_atomically(folder / "table.csv") as csv_file,
        pyarrow.parquet.ParquetWriter(parquet_file, schema, compression="zstd", use_dictionary=_TEXTS) as parquet,
        pyarrow.csv.CSVWriter(csv_file, named, write_options=unquoted) as csv,
    ):
        for start in range(0, len(measurements.hashes), _ROWS):
            frame = table(measurements, rows=slice(start, start + _ROWS))
            parquet.write_table(pyarrow.Table.from_pandas(frame, schema, preserve_index=False))
            texts = [name for name in frame.select_dtypes(exclude="number").columns if name != "hash"]
            cells = {name: frame[name].map({text: table_cell(text) for text in frame[name].unique()}) for name in texts}
            safe = frame.assign(**cells).rename(columns=table_cell)
            csv.write_table(pyarrow.Table.from_pandas(safe, named, preserve_index=False))
    return len(schema)


def with_units(schema: Any, units: Mapping[str, str]) -> Any:
    """Return the schema of a Parquet table with the unit of each metric column in its metadata."""
    for index, column in enumerate(schema.names):
        name, _, kind = column.rpartition(".")
        if name in units and kind != "n":
            schema = schema.set(index, schema.field(index).with_metadata({"unit": units[name]}))
    return schema


def median_ends(ordered: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the ends of the 95 % interval of the median of each row, shape (cells,); NaN for too few values.

    Args:
        ordered: Values, shape (cells, repetitions), ascending, NaN last.
    """
    from runner.statistics import SMALLEST_SAMPLE, median_intervals  # imports SciPy

    counts = np.sum(~np.isnan(ordered), axis=1)
    low, high = np.full((2, len(ordered)), np.nan)
    for count in np.unique(counts[counts >= SMALLEST_SAMPLE]).tolist():
        cells = np.flatnonzero(counts == count)
        low[cells], high[cells] = median_intervals(ordered[cells, :count])
    return low, high


def _columns(name: str, values: FloatArray) -> Iterator[tuple[str, FloatArray]]:
    """Yield the columns of one metric, each of shape (cells,)."""
    ordered = np.sort(values, axis=1)  # NaN, which is not a repetition, comes last
    count = np.sum(~np.isnan(ordered), axis=1)
    yield f"{name}.median", _finite(medians(ordered))
    low, high = median_ends(ordered)
    yield f"{name}.low", _finite(low)
    yield f"{name}.high", _finite(high)
    for share in QUANTILES:
        place = np.maximum(np.ceil(share * count - 1e-9).astype(np.intp) - 1, 0)
        yield f"{name}.q{round(100 * share):02d}", _finite(ordered[np.arange(len(ordered)), place])
    yield f"{name}.n", np.sum(np.isfinite(ordered), axis=1)


def _finite(values: FloatArray) -> FloatArray:
    """Return the values, with NaN for infinite ones."""
    found: FloatArray = np.where(np.isfinite(values), values, np.nan)
    return found
