"""`runner table DIR`: a sweep as one tidy table, Parquet and CSV."""

from collections.abc import Sequence
from pathlib import Path

from runner.commands.arguments import Parser
from runner.config.compose import quiet_environment
from runner.texts import one_line


def main(arguments: Sequence[str]) -> int:
    """Write `table.parquet` and `table.csv` into the sweep's folder; print that folder as the last line."""
    parser = Parser("table", __doc__)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a sweep")
    options = parser.parse_args(arguments)
    quiet_environment()
    from runner import store
    from runner.sweeps.differing import in_words
    from runner.sweeps.measurements import measure_sweep
    from runner.sweeps.table import write_table

    sweep = store.open_sweep(options.folder)
    measurements = measure_sweep(sweep)
    columns = write_table(measurements, options.folder)
    failed = sum(status != "ok" for status in measurements.statuses)
    doubted = sum(map(bool, measurements.caveats))
    count = f"{len(measurements.hashes)} cells, {failed} of them failed, {doubted} with caveats"
    print(f"{count}; {columns} columns: table.parquet, table.csv")
    also = in_words(measurements.differences)
    if also:
        print(one_line(f"{also}; `runner report {options.folder}` lists their values"))
    print(options.folder)
    return 0
