"""Reports on stored runs, on sweeps and their comparison, and on a tuning."""

import hashlib
import os
from collections.abc import Sequence
from pathlib import Path

from runner import store
from runner.base import progress
from runner.base.errors import RunnerError
from runner.config.compose.user_settings import outputs_dir
from runner.reporting import render
from runner.reporting.comparison.report import comparison_document
from runner.reporting.comparison.sweeps import letter
from runner.reporting.document import Document
from runner.reporting.run_report import run_document
from runner.reporting.sweep.report import sweep_document
from runner.reporting.tuning.report import tuning_document
from runner.store.latest import note
from runner.sweeps.measurements import measure_stored
from runner.sweeps.tuning.study import is_tuning, open_tuning


def write(folders: Sequence[Path], metrics: Sequence[str], formats: Sequence[str]) -> Path:
    """Write the report on some runs, sweeps or one tuning; return its folder.

    Args:
        folders: Their folders; of several sweeps, which are held against each other.
        metrics: What a sweep is compared by; the first ranks it.
        formats: "html", "pdf" or both.

    Raises:
        RunnerError: if a folder is none of these, or damaged; for an unknown metric or format.
    """
    document, folder = compose_report(folders, metrics)
    render.write_report(document, folder, formats)
    note(folder)
    return folder


def compose_report(folders: Sequence[Path], metrics: Sequence[str] = ()) -> tuple[Document, Path]:
    """Return the report on some runs, one tuning, or one or more sweeps, and the folder that it is written to.

    Args:
        folders: Those of the runs or sweeps, or that of the tuning.
        metrics: What sweeps are compared by.

    Raises:
        RunnerError: If metrics are given for what is no sweep, or are none of its.
        StoreError: If a run is missing or damaged.
    """
    tunings = [is_tuning(folder) for folder in folders]
    sweeps = [store.is_sweep(folder) for folder in folders]
    if len(folders) > 1 and (any(tunings) or any(sweeps) != all(sweeps)):
        what = "a tuning has a report of its own" if any(tunings) else "runs and sweeps have no report together"
        raise RunnerError(f"{what}; give runs alone, sweeps alone, or one folder")
    if metrics and (any(tunings) or not all(sweeps)):
        raise RunnerError("--metrics is for the report on sweeps")
    reports = _outputs(folders[0]) / "reports"
    names = [folder.resolve().name for folder in folders]
    if any(tunings):
        document, name = tuning_document(open_tuning(folders[0]), reports / "any"), names[0]
    elif not all(sweeps):
        progress.begin("reading runs")
        runs = [run for folder in folders for run in store.open_runs(folder)]
        document, name = run_document(runs), "".join(run.hash for run in runs)
    elif len(sweeps) == 1:
        sweep = store.open_sweep(folders[0])
        address = os.path.relpath(sweep.outputs / "runs", reports / "any") + "/"
        document, name = sweep_document(sweep, metrics, address), " ".join([sweep.folder.name, *metrics])
    else:
        sides = [measure_stored(folder, letter(place)) for place, folder in enumerate(folders)]
        document, name = comparison_document(sides, metrics), " ".join(["compared", *names, *metrics])
    return document, reports / hashlib.sha256(name.encode()).hexdigest()[:24]


def _outputs(folder: Path) -> Path:
    """Return the outputs folder that a run or sweep lies in; ./outputs for a copy that lies elsewhere."""
    place = folder.resolve().parent
    return folder.parent.parent if place.name in ("runs", "sweeps", "tunings") else outputs_dir()
