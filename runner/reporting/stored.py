"""Reports on stored runs, on sweeps and their comparison, on a tuning, a challenge and an identification."""

import hashlib
import os
from collections.abc import Sequence
from pathlib import Path

from runner import store
from runner.base import progress
from runner.base.errors import RunnerError
from runner.reporting import render
from runner.reporting.comparison.sweeps import measure_compared
from runner.reporting.document import Document
from runner.store.axes import axes_of, find_axis
from runner.store.kinds import kind_of, note, outputs_of, report_place
from runner.sweeps.finer_step import work_out, work_out_sweep
from runner.sweeps.question import keep_question


def write(
    folders: Sequence[Path],
    metrics: Sequence[str],
    formats: Sequence[str],
    output: Path | None = None,
    by: Sequence[str] = (),
) -> Path:
    """Write the report on some runs, sweeps, one tuning, one challenge or one identification; return its folder.

    Args:
        folders: Their folders; several sweeps are compared.
        metrics: What a sweep is compared by; the first ranks it.
        formats: "html", "pdf" or both.
        output: Folder to write to; None for one in `reports/` of the outputs folder.
        by: Axis that one sweep asks about from now on; empty for its question.

    Raises:
        RunnerError: if a folder is none of these, or damaged; for an unknown metric, axis or format.
    """
    if by:
        _ask(folders, by)
    document, folder = compose_report(folders, metrics, output)
    render.write_report(document, folder, formats)
    note(folder)
    return folder


def _ask(folders: Sequence[Path], by: Sequence[str]) -> None:
    """Store the axis that a sweep asks about.

    Raises:
        RunnerError: If there is not one sweep and one of its axes.
    """
    if len(folders) != 1 or len(by) != 1 or kind_of(folders[0]) != "sweep":
        raise RunnerError(f"--by: not for these results ({','.join(by)}). Allowed: one axis of one sweep.")
    sweep = store.open_sweep(folders[0])
    keep_question(sweep, find_axis(axes_of(sweep.overrides)[0], by[0], "--by").name)


def compose_report(
    folders: Sequence[Path], metrics: Sequence[str] = (), output: Path | None = None
) -> tuple[Document, Path]:
    """Return the report on runs, sweeps, one tuning, one challenge or one identification, and the folder for it.

    Args:
        folders: Those of the runs or sweeps, or that of the tuning, challenge or identification.
        metrics: What sweeps are compared by.
        output: Folder that it is written to; None for one in `reports/` of the outputs folder.

    Raises:
        RunnerError: If metrics are given without a sweep, or a sweep lacks them.
        StoreError: If a run is missing or damaged.
    """
    tunings = [folder for folder in folders if kind_of(folder) == "tuning"]
    challenges = [folder for folder in folders if kind_of(folder) == "challenge"]
    identified = [folder for folder in folders if kind_of(folder) == "identification"]
    others = (*tunings, *challenges, *identified)
    things = [store.open_stored(folder) for folder in folders if folder not in others]
    sweeps = [thing for thing in things if isinstance(thing, store.Sweep)]
    runs = [thing for thing in things if isinstance(thing, store.Run)]
    place = output or report_place(outputs_of(folders[0]), report_name(folders, metrics))
    if len(folders) > 1 and len(folders) not in (len(sweeps), len(runs)):
        raise RunnerError("these results have no common report. Allowed: only runs, only sweeps, or one folder.")
    if metrics and not sweeps:
        raise RunnerError(f"--metrics: {folders[0]} is not a sweep. Allowed: only for sweeps.")
    if tunings:
        from runner.reporting.sweep.tuning import tuning_document  # Hydra, which sweeps do without
        from runner.sweeps.tuning.study import open_tuning

        document = tuning_document(open_tuning(tunings[0]), place)
    elif challenges:
        from runner.reporting.challenge.page import challenge_document
        from runner.sweeps.challenge.stored import open_challenge

        document = challenge_document(open_challenge(challenges[0]), store.open_sweep(challenges[0]))
    elif identified:
        from runner.identification.result import open_identification
        from runner.reporting.identification_report import identification_document

        document = identification_document(open_identification(identified[0]))
    elif runs:
        from runner.reporting.comparison.runs import runs_document
        from runner.reporting.run_report import run_document

        progress.begin("reading runs")
        if len(runs) > 1:
            work_out(runs[0].outputs, runs)
        document = run_document(runs[0]) if len(runs) == 1 else runs_document(runs)
    elif len(sweeps) == 1:
        from runner.reporting.sweep.report import sweep_document

        work_out_sweep(sweeps[0])
        address = os.path.relpath(sweeps[0].outputs / "runs", place) + "/"
        document = sweep_document(sweeps[0], metrics, address)
    else:
        from runner.reporting.comparison.report import comparison_document

        sides = measure_compared(sweeps)
        document = comparison_document(sides, metrics)
    return document, place


def report_name(folders: Sequence[Path], metrics: Sequence[str] = ()) -> str:
    """Return the name of the folder of a report on some results."""
    names = [folder.resolve().name for folder in folders]
    return hashlib.sha256(" ".join([*names, *metrics]).encode()).hexdigest()[:24]
