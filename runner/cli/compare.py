"""Compare runs or sweeps, the first with each of the others.

With one sweep, it compares the values of an axis: --by, else its question. A log of a real arm is compared with a run,
or with --robot with one that its commands drive; the last line is the report's folder.

Example: runner compare latest --by controller --within robot
"""

import json
import math
import sys
from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.base.errors import RunnerError
from runner.base.sanitize import one_line
from runner.cli.arguments import Parser, StoredFolder, config_folder, seconds
from runner.store.kinds import kind_of

if TYPE_CHECKING:
    from runner.recordings.compare import RecordingComparison
    from runner.reporting.document import Document
    from runner.store import Run, Sweep
    from runner.sweeps.measurements import Measurements

# A missing file of such a name is called a log.
_LOGS = (".csv", ".tsv", ".txt", ".log", ".parquet", ".zip", ".npz", ".bag", ".mcap", ".db3")


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.usage = "runner compare [OPTION ...] DIR [DIR ...]"  # argparse would list all options
    parser.add_argument(
        "folders",
        nargs="+",
        type=StoredFolder("run", "sweep", other=_is_recording),
        metavar="DIR",
        help="runs, sweeps, latest, or a log of an arm",
    )
    parser.add_shared(
        metrics="metrics (default: five; all with --all or --json)",
        json="print JSON, one object for each row",
        by="one sweep: axes, the first its new question",
        within="within each level of these axes (default: over all)",
        where="only cells with this value of a key; repeatable",
        output="recording: folder of the report",
    )
    parser.add_argument("--all", action="store_true", help="print every metric and the method")
    parser.add_argument("--columns", type=Path, metavar="FILE", help="recording: YAML of the signal in each column")
    parser.add_argument(
        "--fill-gaps", type=seconds, metavar="TIME", help="recording: longest gap to fill, such as 20ms"
    )
    parser.add_argument("--robot", metavar="ROBOT", help="log: simulate its motion with this robot")
    parser.add_argument("--controller", metavar="NAME", help="log: of that run (default: computed_torque)")
    parser.add_argument(
        "--config-dir",
        type=config_folder,
        action="append",
        default=[],
        metavar="DIR",
        help="log: your folder of YAML and URDFs; repeatable",
    )


def run(options: Namespace) -> int:
    """Print the comparison."""
    recordings = [path for path in options.folders if _is_recording(path)]
    if recordings or options.columns or options.fill_gaps or options.robot or options.controller:
        _compare_recording(options.folders, recordings, options)
    else:
        _compare(options)
    return 0


def _compare(options: Namespace) -> None:
    from runner.reporting.challenge.beside import scope_line
    from runner.reporting.comparison.sweeps import (
        answer_rows,
        compare_levels,
        compare_runs,
        compare_sweeps,
        measure_compared,
    )
    from runner.reporting.comparison.text import level_lines, run_lines, sweep_lines
    from runner.reporting.sweep.subject import main_metrics
    from runner.store.axes import find_axis
    from runner.store.opening import open_stored
    from runner.store.run import Run
    from runner.store.sweep import Sweep
    from runner.sweeps.measurements import check_metrics, limit_sweep
    from runner.sweeps.question import keep_question

    everything, things = options.all or options.json, list(map(open_stored, options.folders))
    runs = [thing for thing in things if isinstance(thing, Run)]
    sweeps = [thing for thing in things if isinstance(thing, Sweep)]
    if options.output:
        raise RunnerError(f"--output: nothing is written ({options.output}). Allowed: only with a recording.")
    if options.within and (len(things) > 1 or runs):
        raise RunnerError("--within: not for these results. Allowed: only for one sweep.")
    if (options.by and (len(things) > 1 or runs)) or (options.where and runs):
        option, allowed = ("--by", "one sweep") if options.by else ("--where", "sweeps")
        raise RunnerError(f"{option}: not for these results. Allowed: only for {allowed}.")
    if len(things) == 1 and not options.by:
        options.by = [_question(*runs, *sweeps)]
    if runs and sweeps:
        raise RunnerError(_explain_mixture(runs[0], sweeps[0]))
    sweeps = [limit_sweep(sweep, options.where) for sweep in sweeps]
    first, *others = sides = measure_compared(runs or sweeps)
    for side in sides:
        for damage in side.damage:
            print(f"runner: {damage}", file=sys.stderr)
    metrics = options.metrics or (() if everything else main_metrics(sides))
    if options.by:
        for option in ("by", "within"):
            for name in getattr(options, option) or ():
                _check_levels(sweeps[0], first, name)
                find_axis(first.axes, name, f"--{option}")
        keep_question(sweeps[0], options.by[0])
        by_axis = {axis: compare_levels(first, axis, options.within or None, metrics) for axis in options.by}
        answers = [answer for some in by_axis.values() for answer in some]
        texts = ["\n".join(level_lines(first, axis, some, everything)) for axis, some in by_axis.items()]
    elif sweeps or options.json:
        found = [compare_sweeps(first, other, metrics) for other in others]
        answers = [answer for one in found for answer in one.answers]
        texts = ["\n".join(sweep_lines(one, everything)) for one in found]
    else:
        check_metrics(metrics, [name for side in sides for name in side.values])
        texts = ["\n".join(run_lines((runs[0], run), (first, other), metrics, everything))
                 for run, other in zip(runs[1:], others, strict=True)]  # fmt: skip
        answers = [answer for other in others for answer in compare_runs(first, other, metrics)[0]]
    if options.json:
        print(_json_text(answer_rows(answers)))
        return
    print("\n\n".join(texts))
    words = [*map(str, options.folders), *(["--metrics", options.metrics[0]] if options.metrics else [])]
    if line := scope_line(answers, [thing.folder for thing in things], words):
        print(one_line(line))


def _json_text(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return rows as JSON; a value without a number, which JSON cannot represent, becomes null."""
    finite = [
        {key: None if isinstance(value, float) and not math.isfinite(value) else value for key, value in row.items()}
        for row in rows
    ]
    return json.dumps(finite, indent=2, allow_nan=False)


def _question(thing: "Run | Sweep") -> str:
    """Return the axis that a sweep asks about.

    Raises:
        RunnerError: If the result is a run, or all axes of the sweep are conditions.
    """
    from runner.store import Run
    from runner.store.axes import axes_of
    from runner.sweeps.question import find_question

    folder = thing.folder
    if isinstance(thing, Run):
        raise RunnerError(f"{folder}: only one run. Add a second one: `runner compare {folder} OTHER`")
    axes, _ = axes_of(thing.overrides)
    asked = find_question(axes, thing.question)
    if asked is None:
        known = ", ".join(axis.name for axis in axes) or "nothing"
        raise RunnerError(
            f"{folder}: only one sweep, over conditions only. Add a second one, or compare the levels of an axis "
            f"({known}): `runner compare {folder} --by AXIS`"
        )
    return asked.name


def _check_levels(sweep: "Sweep", stored: "Measurements", name: str) -> None:
    """Check that the stored cells of a sweep still have several values of an axis that it was made over.

    Raises:
        RunnerError: If they do not; says how to make the others.
    """
    from runner.store.axes import axes_of

    axes, _ = axes_of(sweep.overrides)
    if name in {axis.name for axis in axes} - {axis.name for axis in stored.axes}:
        known = f"{len(stored.hashes)} of {len(sweep.overrides)} cells can be read, with one value of {name}"
        raise RunnerError(f"{sweep.folder}: {known}: nothing to compare. Make the others: `{stored.command}`")


def _explain_mixture(run: "Run", sweep: "Sweep") -> str:
    """Return the reason why a run and a sweep are not compared, and an alternative."""
    folder, names = sweep.folder, list(sweep.hashes)
    what = f"{run.folder} is a run and {folder} is a sweep. Allowed: only runs, or only sweeps"
    if run.hash in names:
        cell = " ".join(sweep.overrides[names.index(run.hash)])
        return (
            f"{what}. This run is the cell {cell} of the sweep; `runner compare {folder} --by AXIS` compares the cells "
            "with each other"
        )
    first = " ".join(sweep.overrides[0])
    return (
        f"{what}. A cell of the sweep is also a run; `runner {first}` prints the folder of the first one, to compare "
        f"{run.folder} with"
    )


def _is_recording(path: Path) -> bool:
    if kind_of(path):
        return False
    if not path.is_dir():
        return path.is_file() or path.suffix.lower() in _LOGS
    from runner.recordings.files import is_log_folder

    return is_log_folder(path)


def _compare_recording(given: Sequence[Path], recordings: Sequence[Path], options: Namespace) -> None:
    folders = [path for path in given if path not in recordings]
    if options.by or options.within or options.metrics or options.where or options.json or options.all:
        raise RunnerError("--by, --within, --where, --metrics, --json and --all: not for recordings.")
    if options.robot:
        if len(recordings) != 1 or folders:
            raise RunnerError("--robot: not one log. Allowed: `runner compare LOG --robot ROBOT`, which makes the run.")
        _replay(recordings[0], options)
        return
    if options.controller:
        raise RunnerError("--controller: no run is made without --robot. Allowed: `runner compare LOG --robot ROBOT`.")
    if len(recordings) != 1 or len(folders) != 1:
        raise RunnerError(
            "recordings: not one run and one recording. Allowed: `runner compare RUN recording.csv --columns map.yaml` "
            "or `runner compare recording.csv --robot ROBOT`."
        )
    if options.columns is None:
        raise RunnerError(f"{recordings[0]}: add --columns FILE, which describes its columns (docs/recordings.md).")
    if kind_of(folders[0]) != "run":
        raise RunnerError(f"{folders[0]}: it is a sweep. Allowed: one run and one recording.")
    from runner import store
    from runner.base import progress
    from runner.recordings.compare import compare_recording

    progress.begin("reading runs")
    run = store.open_run(folders[0])
    found = compare_recording(run, recordings[0], options.columns, options.fill_gaps or 0.0)
    _print_recording(found, options)


def _replay(recording: Path, options: Namespace) -> None:
    """Make the run of a log, and compare it with the log."""
    from runner.cli.replay import replay
    from runner.config.compose.files import outputs_dir
    from runner.recordings.compare import compare_recording

    made = replay(
        recording,
        options.robot,
        outputs_dir(),
        options.controller or "computed_torque",
        options.columns,
        options.config_dir,
        options.fill_gaps or 0.0,
    )
    for note in made.notes:
        print(one_line(f"runner: motion: {note}"), file=sys.stderr)
    if made.run.status != "ok":
        raise RunnerError(
            f"{made.run.folder}: the run {made.run.failure}; it cannot be compared. Try another --controller."
        )
    found = compare_recording(
        made.run,
        recording,
        made.columns,
        options.fill_gaps or 0.0,
        not made.commanded,
        made.recording,
    )
    _print_recording(found, options)


def _print_recording(found: "RecordingComparison", options: Namespace) -> None:
    """Print the differences between a recording and a run, and write the report; its folder is the last line."""
    from runner.reporting.recording_report import recording_document, report_folder
    from runner.reporting.render import write_report
    from runner.store.kinds import note

    document = recording_document(found)
    print(_recording_text(found, document), end="\n\n")
    made = options.output or report_folder(found)
    write_report(document, made)
    note(made)
    print(made)


def _recording_text(found: "RecordingComparison", report: "Document") -> str:
    """Return the printed verdict and tables: those of the report, but for that of metrics, which has titles there."""
    from runner.plugins.metric_units import unit_of
    from runner.recordings import words
    from runner.recordings.verdict import verdict_lines
    from runner.reporting.table import Cell, Number, Table, numbers, terminal

    tables = {
        section.title: [block for block in section.blocks if isinstance(block, Table)] for section in report.sections
    }
    metrics: list[list[Cell]] = [
        [name, unit_of(name) or "", *map(Number, both)] for name, both in found.metrics.items()
    ]
    parts = [
        *verdict_lines(found),
        "",
        f"run        {found.run.folder}",
        f"recording  {found.recording.path}",
        one_line(words.aligned_text(found)),
        "",
        *(terminal(table, indent="") for table in tables["Residuals"]),
        *(line for table in tables.get("Motions", ()) for line in ("", table.caption, terminal(table, indent=""))),
        "",
        one_line(words.FIT),
        "",
        terminal(Table("", ["metric", "unit", *numbers("run", "recording")], metrics), indent=""),
        "",
        *words.lag_lines(found),
        *words.friction_lines(found),
    ]
    return "\n".join([*parts, *(terminal(table, indent="") for table in tables["Friction"])])
