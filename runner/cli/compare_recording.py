"""Comparison of a recording with a run for `runner compare`: printed, and written as a report."""

from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.sanitize import one_line
from runner.cli.columns import align_columns, number

if TYPE_CHECKING:
    from runner.recordings.compare import RecordingComparison


def print_recording(folder: Path, recording: Path, columns: Path, fill_gaps: float) -> None:
    """Print how a recording differs from a run, and write the report; its folder is the last line.

    Args:
        folder: The run's.
        recording: The recording, CSV or a ROS bag.
        columns: What its columns are, YAML.
        fill_gaps: Longest gap of the recording that is filled, in s; 0 for none.

    Raises:
        RunnerError: if one of them cannot be read, or the recording does not fit the run.
    """
    from runner import store
    from runner.base import progress
    from runner.recordings.compare import compare_recording
    from runner.reporting.recording_report import recording_document, report_folder
    from runner.reporting.render import write_report
    from runner.store.latest import note

    progress.begin("reading runs")
    found = compare_recording(store.open_run(folder), recording, columns, fill_gaps)
    print(_told(found), end="\n\n")
    made = report_folder(found)
    write_report(recording_document(found), made)
    note(made)
    print(made)


def _told(found: "RecordingComparison") -> str:
    from runner.recordings import words

    parts = [
        f"run        {found.run.folder}",
        f"recording  {found.recording.path}",
        one_line(words.aligned_text(found)),
        "",
        align_columns([words.RESIDUAL_HEADER, *words.residual_rows(found, number)], indent=""),
        "",
        one_line(words.FIT),
        "",
        align_columns([["metric", "unit", "run", "recording"], *words.metric_rows(found, number)], indent=""),
        "",
        *words.friction_lines(found),
    ]
    rows = words.friction_rows(found, number)
    return "\n".join([*parts, *([align_columns([words.FRICTION_HEADER, *rows], indent="")] if rows else [])])
