"""`runner report DIR... [--html] [--pdf]`: a report from stored runs or sweeps."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

from runner.commands.arguments import Parser
from runner.config.compose import quiet_environment


def main(arguments: Sequence[str]) -> int:
    """Write the report; print its folder as the last line."""
    parser = Parser("report", __doc__)
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR", help="run or sweep folders")
    parser.add_argument("--html", action="store_true", help="only HTML (with --pdf: both)")
    parser.add_argument("--pdf", action="store_true", help="only PDF (with --html: both)")
    options = parser.parse_args(arguments)
    quiet_environment()
    from runner import store
    from runner.reporting.render import write_report
    from runner.reporting.run_report import run_document

    runs = [run for folder in options.folders for run in store.open_runs(folder)]
    formats = [name for name in ("html", "pdf") if getattr(options, name)] or ["html", "pdf"]
    name = hashlib.sha256("".join(run.hash for run in runs).encode()).hexdigest()[:24]
    folder = _outputs(options.folders[0]) / "reports" / name
    write_report(run_document(runs), folder, formats)
    print(folder)
    return 0


def _outputs(folder: Path) -> Path:
    """Return the outputs folder that a run or sweep lies in; ./outputs for a copy that lies elsewhere."""
    place = folder.resolve().parent
    return folder.parent.parent if place.name in ("runs", "sweeps") else Path("outputs")
