"""`runner table DIR`: a sweep as one tidy table, Parquet and CSV."""

from collections.abc import Sequence
from pathlib import Path

from runner.commands.arguments import Parser
from runner.config.compose import quiet_environment


def main(arguments: Sequence[str]) -> int:
    """Write `table.parquet` and `table.csv` into the sweep's folder; print that folder as the last line."""
    parser = Parser("table", __doc__)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a sweep")
    options = parser.parse_args(arguments)
    quiet_environment()
    from runner import store
    from runner.sweeps.measurements import measure
    from runner.sweeps.table import write_table

    sweep = store.open_sweep(options.folder)
    frame = write_table(measure(sweep.overrides, sweep.runs()), options.folder)
    failed = int((frame["status"] != "ok").sum())
    print(f"{len(frame)} cells, {failed} of them failed; {len(frame.columns)} columns: table.parquet, table.csv")
    print(options.folder)
    return 0
