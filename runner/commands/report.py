"""`runner report DIR... [--html] [--pdf] [--metric NAME]`: a report from stored runs or a sweep."""

import hashlib
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner.commands.arguments import Parser
from runner.config.compose import quiet_environment
from runner.errors import RunnerError

if TYPE_CHECKING:
    from runner.reporting.document import Document


def main(arguments: Sequence[str]) -> int:
    """Write the report; print its folder as the last line."""
    parser = Parser("report", __doc__)
    parser.add_argument(
        "folders", nargs="+", type=Path, metavar="DIR", help="run folders, or the folder of one sweep or tuning"
    )
    parser.add_argument("--html", action="store_true", help="only HTML (with --pdf: both)")
    parser.add_argument("--pdf", action="store_true", help="only PDF (with --html: both)")
    parser.add_argument(
        "--metric", action="append", default=[], metavar="NAME", help="what a sweep is compared by; the first ranks it"
    )
    options = parser.parse_args(arguments)
    quiet_environment()
    from runner import store
    from runner.reporting.render import write_report
    from runner.tuning.study import is_tuning

    one_tuning = len(options.folders) == 1 and is_tuning(options.folders[0])
    one_sweep = len(options.folders) == 1 and store.is_sweep(options.folders[0]) and not one_tuning
    if options.metric and not one_sweep:
        raise RunnerError("--metric is for the report on one sweep")
    formats = [name for name in ("html", "pdf") if getattr(options, name)] or ["html", "pdf"]
    reports = _outputs(options.folders[0]) / "reports"
    make = _of_tuning if one_tuning else _of_sweep if one_sweep else _of_runs
    document, name = make(options.folders, options.metric, reports)
    folder = reports / hashlib.sha256(name.encode()).hexdigest()[:24]
    write_report(document, folder, formats)
    print(folder)
    return 0


def _of_runs(folders: Sequence[Path], _: Sequence[str], __: Path) -> "tuple[Document, str]":
    from runner import store
    from runner.reporting.run_report import run_document

    runs = [run for folder in folders for run in store.open_runs(folder)]
    return run_document(runs), "".join(run.hash for run in runs)


def _of_sweep(folders: Sequence[Path], metrics: Sequence[str], reports: Path) -> "tuple[Document, str]":
    from runner import store
    from runner.reporting.sweep.report import sweep_document

    sweep = store.open_sweep(folders[0])
    address = os.path.relpath(sweep.outputs / "runs", reports / "any") + "/"
    return sweep_document(sweep, metrics, address), " ".join([sweep.folder.name, *metrics])


def _of_tuning(folders: Sequence[Path], _: Sequence[str], reports: Path) -> "tuple[Document, str]":
    from runner.reporting.tuning.report import tuning_document
    from runner.tuning.study import open_tuning

    return tuning_document(open_tuning(folders[0]), reports / "any"), folders[0].resolve().name


def _outputs(folder: Path) -> Path:
    """Return the outputs folder that a run or sweep lies in; ./outputs for a copy that lies elsewhere."""
    place = folder.resolve().parent
    return folder.parent.parent if place.name in ("runs", "sweeps", "tunings") else Path("outputs")
