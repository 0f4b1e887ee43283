"""`runner compare A B ...`: compare runs or sweeps, the first with each of the others.

Sweeps are compared by cell and repetition. `runner compare SWEEP --by controller --within robot` compares the levels
of an axis of one sweep. `runner compare RUN recording.csv --columns map.yaml` compares the recording of a real arm
with a run, and writes a report; its folder is the last line.
"""

from argparse import ArgumentTypeError, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.environment_variables import quiet_environment
from runner.base.errors import RunnerError
from runner.cli.arguments import Parser, Stored, name_list
from runner.recordings import is_bag
from runner.schema.units import read_quantity

if TYPE_CHECKING:
    from runner.store import Run


class StoredOrRecording(Stored):
    """The type of an argument that is the folder of something stored, or a recording."""

    def __call__(self, text: str) -> Path:
        """Return the folder or the file that a text names."""
        return Path(text) if _is_recording(text) else super().__call__(text)


def main(arguments: Sequence[str]) -> int:
    """Print the comparison."""
    parser = Parser("compare", __doc__)
    parser.add_argument(
        "folders",
        nargs="+",
        type=StoredOrRecording(("run", "sweep")),
        metavar="DIR",
        help="runs, or sweeps; or latest; or a run and a recording, a CSV file or a ROS bag",
    )
    parser.add_argument("--metrics", type=name_list, metavar="A,B", help="compare only these metrics")
    parser.add_argument("--by", metavar="AXIS", help="of one sweep: compare the levels of this axis")
    parser.add_argument(
        "--within",
        type=name_list,
        metavar="AXIS,AXIS",
        help="within each level of these; default: over all others and within each",
    )
    parser.add_argument("--columns", type=Path, metavar="FILE", help="of a recording: which signal each column holds")
    parser.add_argument(
        "--fill-gaps", type=_seconds, metavar="TIME", help="of a recording: fill gaps of up to this, such as 20ms"
    )
    options = parser.parse_args(arguments)
    metrics, within = options.metrics or (), options.within or None
    quiet_environment()
    from runner import store

    recordings = [path for path in options.folders if _is_recording(path)]
    if recordings or options.columns or options.fill_gaps:
        _compare_recording(options.folders, recordings, options)
        return 0
    sweeps = [store.is_sweep(folder) for folder in options.folders]
    if within and not options.by:
        raise RunnerError("--within goes with --by AXIS, which says what is compared")
    if options.by:
        if len(options.folders) > 1 or not sweeps[0]:
            raise RunnerError("--by is for one sweep: `runner compare SWEEP --by AXIS`")
        from runner.cli.compare_levels import print_levels

        print_levels(options.folders[0], options.by, within, metrics)
    elif len(options.folders) == 1:
        raise RunnerError(_alone(options.folders[0], sweeps[0]))
    elif all(sweeps):
        from runner.cli.compare_sweeps import print_sweeps

        print_sweeps(options.folders, metrics)
    else:
        from runner.cli.compare_runs import print_runs

        runs = [None if is_sweep else store.open_run(folder)
                for folder, is_sweep in zip(options.folders, sweeps, strict=True)]  # fmt: skip
        alone = [run for run in runs if run is not None]
        if any(sweeps):
            raise RunnerError(_mixed(alone[0], options.folders[sweeps.index(True)]))
        print_runs(alone, metrics)
    return 0


def _is_recording(path: str | Path) -> bool:
    return Path(path).suffix.lower() == ".csv" or is_bag(Path(path))


def _compare_recording(given: Sequence[Path], recordings: Sequence[Path], options: Namespace) -> None:
    from runner import store

    folders = [path for path in given if path not in recordings]
    if len(recordings) != 1 or len(folders) != 1:
        raise RunnerError("a recording is compared with one run: `runner compare RUN recording.csv --columns map.yaml`")
    if options.columns is None:
        raise RunnerError(
            f"{recordings[0]} is a recording; say by --columns FILE which signal each column holds (docs/recordings.md)"
        )
    if store.is_sweep(folders[0]):
        raise RunnerError(f"{folders[0]} is a sweep; a recording is compared with one run")
    if options.by or options.within or options.metrics:
        raise RunnerError("--by, --within and --metrics are not for recordings")
    from runner.cli.compare_recording import print_recording

    print_recording(folders[0], recordings[0], options.columns, options.fill_gaps or 0.0)


def _seconds(text: str) -> float:
    found = read_quantity(text)
    seconds = None if found is None else found.in_unit("s")
    if seconds is None or seconds <= 0.0:
        raise ArgumentTypeError(f"must be a time above 0, such as 20ms; found {text!r}")
    return seconds


def _alone(folder: Path, is_sweep: bool) -> str:
    """Return what is missing beside one folder."""
    from runner import store

    if not is_sweep:
        store.open_run(folder)  # what is no run either is told first
        return f"{folder} is one run alone; give a second one to compare it with: `runner compare {folder} OTHER`"
    from runner.sweeps.measurements import axes_of

    axes, _ = axes_of(store.open_sweep(folder).overrides)
    known = ", ".join(axis.name for axis in axes) or "nothing"
    return (
        f"{folder} is one sweep alone; compare the levels of one of its axes (it was swept over: {known}) by "
        f"`runner compare {folder} --by AXIS`, or give a second sweep"
    )


def _mixed(run: "Run", folder: Path) -> str:
    """Return what would work in place of a run against a sweep."""
    from runner import store

    sweep = store.open_sweep(folder)
    what = f"{run.folder} is a run and {folder} a sweep; compare runs with runs, and sweeps with sweeps"
    names = list(sweep.hashes)
    if run.hash in names:
        cell = " ".join(sweep.overrides[names.index(run.hash)])
        return (
            f"{what}: this run is the sweep's cell {cell}; `runner compare {folder} --by AXIS` holds the cells against "
            "each other"
        )
    first = " ".join(sweep.overrides[0])
    return (
        f"{what}: a cell of the sweep is a run as well; `runner {first}` prints the folder of the first one, to "
        f"compare {run.folder} with"
    )
