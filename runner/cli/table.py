"""Export a sweep or run as a table: Parquet or CSV for data, Markdown, LaTeX or Typst for papers.

Without options, all cells of a sweep are written to table.parquet and table.csv in its folder.

Example: runner table latest --format latex --by controller --output table.tex
"""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.errors import RunnerError, unknown
from runner.base.sanitize import one_line
from runner.cli.arguments import WIDTHS, Parser, StoredFolder, millimetres, put

if TYPE_CHECKING:
    from runner.sweeps.measurements import Measurements

_ENDINGS = {".csv": "csv", ".parquet": "parquet", ".md": "markdown", ".tex": "latex", ".typ": "typst"}
_OF_WIDTH = ("latex", "typst")
_FOR_PAPER = ("markdown", *_OF_WIDTH)
FORMATS = tuple(_ENDINGS.values())


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    stored = StoredFolder("sweep", "run", "tuning")
    parser.add_argument("folder", type=stored, metavar="DIR", help="folder of a sweep or run, or latest")
    parser.add_formats(FORMATS, f"{', '.join(FORMATS)} (default: by the name of --output)", most=1)
    parser.add_shared(
        metrics="metrics (default: all)",
        by="one row for each combination of these axes",
        where="only cells with this value, swept or in the config; repeat for more",
        output="file to write (default: standard output)",
    )
    parser.add_argument("--width", metavar="W", help=f"latex and typst: {WIDTHS} that the table fits (default: any)")


def run(options: Namespace) -> int:
    """Write the whole table into the sweep's folder, and print the folder; or the table that the options choose."""
    chosen = _format(options)
    width = _width(options.width, chosen)
    from runner import store
    from runner.store.kinds import kind_of
    from runner.sweeps.measurements import limit_sweep, measure_sweep, split_where

    if kind_of(options.folder) == "run":
        return _of_run(options, chosen, width)
    sweep = store.open_sweep(options.folder)
    swept, others = split_where(sweep, options.where)
    measurements = measure_sweep(limit_sweep(sweep, others))
    if not (chosen or options.metrics or options.by or options.where):
        return _whole(options.folder, measurements)
    if chosen in _FOR_PAPER:
        from runner.reporting.export.paper_table import of_sweep

        table = of_sweep(measurements, sweep.command, options.metrics, options.by, swept)
        put(table.written(chosen, width), options.output)
        return 0
    from runner.reporting.export.pooling import as_csv, as_parquet, selection

    frame = selection(measurements, options.metrics, options.by, swept)
    put(as_parquet(frame, measurements) if chosen == "parquet" else as_csv(frame), options.output)
    return 0


def _format(options: Namespace) -> str:
    """Return the requested format, by its name or by the suffix of the file; empty if none is requested."""
    chosen: str = (options.format or [""])[0]
    if not chosen and options.output is not None:
        chosen = _ENDINGS.get(options.output.suffix.lower(), "")
        if not chosen:
            raise RunnerError(unknown("ending", options.output.suffix, _ENDINGS, f"--output {options.output}"))
    if chosen == "parquet" and options.output is None:
        raise RunnerError("--format: Parquet cannot be printed. Add --output FILE.")
    return chosen


def _width(text: str | None, chosen: str) -> float | None:
    """Return the width that the table fits, in mm; None for any."""
    if text is not None and chosen not in _OF_WIDTH:
        raise RunnerError(
            f"--width: not with {chosen or 'the whole table'} ({text}). Allowed: --format latex or typst."
        )
    return None if text is None else millimetres(text)


def _whole(folder: Path, measurements: "Measurements") -> int:
    from runner.base.atomic import refuse_links
    from runner.store.kinds import KINDS
    from runner.sweeps.differing import in_words
    from runner.sweeps.table import write_table

    if folder.parent.name in (KINDS["sweep"].folder, KINDS["tuning"].folder):
        refuse_links(folder.parent.parent, folder)
    columns = write_table(measurements, folder)
    doubted = sum(map(bool, measurements.caveats))
    count = f"{len(measurements.hashes)} cells, {measurements.failed} of them failed, {doubted} with caveats"
    print(f"{count}; {columns} columns: table.parquet, table.csv")
    also = in_words(measurements.differences)
    if also:
        print(one_line(f"{also}; `runner report {folder}` lists their values"))
    print(folder)
    return 0


def _of_run(options: Namespace, chosen: str, width: float | None) -> int:
    """Print or write the table of a run, one row per metric; without options, as Markdown with the folder."""
    from runner import store

    if options.by or options.where:
        raise RunnerError(f"--by and --where: {options.folder} is a run. Allowed: only for sweeps.")
    run = store.open_run(options.folder)
    if not run.metrics:
        raise RunnerError(f"the run has no metrics: it {run.failure}")
    if chosen in ("", *_FOR_PAPER):
        from runner.reporting.export.paper_table import of_run

        put(of_run(run, options.metrics).written(chosen or "markdown", width), options.output)
        if not chosen:
            print(options.folder)
        return 0
    from runner.reporting.export.pooling import as_csv, as_parquet, of_one
    from runner.sweeps.measurements import measure_run

    measured = measure_run(run)
    frame = of_one(measured, options.metrics)
    put(as_parquet(frame, measured) if chosen == "parquet" else as_csv(frame), options.output)
    return 0
