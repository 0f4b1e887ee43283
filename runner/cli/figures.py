"""Write each figure of a report as SVG, PDF and CSV, in the width of a journal column, or a motion as a GIF or video.

Example: runner figures latest --width double
"""

import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.errors import RunnerError, unknown
from runner.base.sanitize import one_line
from runner.cli.arguments import WIDTHS, Parser, StoredFolder, millimetres
from runner.cli.commands import find_document

if TYPE_CHECKING:
    from runner.reporting.charts.sheet import Sheet
    from runner.reporting.document import Document
    from runner.reporting.export.figures import Figure
    from runner.store import Run

_MOTIONS = (".gif", ".mp4")


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "folders",
        type=StoredFolder("run", "sweep", "tuning", other=find_document),
        nargs="+",
        metavar="DIR",
        help="a run, sweep or tuning; several runs or sweeps to compare; a study's name or folder; or latest",
    )
    parser.add_shared(output="folder to write (default: figures/ in the report's folder)")
    parser.add_argument(
        "--width",
        default="single",
        metavar="W",
        help=f"{WIDTHS} (default: single)",
    )
    parser.add_argument("--only", metavar="NAME", help="figures whose names begin so (default: all)")
    parser.add_argument("--motion", type=Path, metavar="FILE", help="write the first motion to FILE: .gif or .mp4")


def run(options: Namespace) -> int:
    """Write the figures; print their folder as the last line."""
    width = millimetres(options.width)
    if options.motion is not None and options.motion.suffix.lower() not in _MOTIONS:
        raise RunnerError(unknown("ending", options.motion.suffix, _MOTIONS, f"--motion {options.motion}"))
    if options.motion is not None and options.output is not None:
        raise RunnerError(f"--output: not with --motion ({options.output}), which names its own file.")
    from runner.reporting.charts.sheet import column
    from runner.reporting.export.figures import choose_figures, figures_of, tell_widths, write_figures
    from runner.store.kinds import report_place

    document, report = _document(options.folders)
    figures = choose_figures(figures_of(document), options.only)
    if options.motion is not None:
        print(_write_motion(figures, options.motion, column(width)))
        return 0
    folder = options.output or report_place(report.parent.parent, f"{report.name}/figures")
    for text in tell_widths(figures, column(width)):
        print(f"runner: {text}", file=sys.stderr)
    for name in write_figures(figures, folder, column(width)):
        print(name)
    print(folder)
    return 0


def _write_motion(figures: "Mapping[str, Figure]", path: Path, sheet: "Sheet") -> Path:
    """Write the first motion; print what it shows and which format it has."""
    from runner.reporting.document import Playback
    from runner.reporting.export.motion import speed_told, write_motion

    motion = next((figure for figure in figures.values() if isinstance(figure, Playback)), None)
    if motion is None:
        raise RunnerError("--motion: the report has no motion. Allowed: a run with a trace, or a sweep of such runs.")
    for who, run in zip(("the arm", "the grey arm"), (motion, *motion.others[-1:]), strict=False):
        if run.name:
            print(one_line(f"runner: {who} is {run.name}"), file=sys.stderr)
    if told := speed_told(motion):
        print(f"runner: {told}", file=sys.stderr)
    written = write_motion(motion, path, sheet)
    if written != path:
        print("runner: no ffmpeg is installed, so that the motion is a GIF", file=sys.stderr)
    return written


def _document(paths: Sequence[Path]) -> "tuple[Document, Path]":
    others = [compose for path in paths if (compose := find_document(path)) is not None]
    if others and len(paths) > 1:
        raise RunnerError("DIR: a study among several results. Allowed: one study, or runs, or sweeps.")
    if others:
        return others[0]()
    from runner import store
    from runner.reporting.stored import compose_report
    from runner.store.kinds import kind_of

    for path in paths:
        if kind_of(path) == "run":
            _tell_failure(store.open_run(path))
    return compose_report(paths)


def _tell_failure(run: "Run") -> None:
    """Print that a run failed, and the end of its trace; raise an error if it has no trace to draw."""
    if run.status == "ok":
        return
    times = run.t if (run.folder / "trace.parquet").exists() else ()
    if len(times) < 2:
        raise RunnerError(f"{run.folder}: the run {run.failure}; it has no trace to draw")
    print(f"runner: the run {run.failure}; its figures show repetition 0, up to {max(times):.4g} s", file=sys.stderr)
