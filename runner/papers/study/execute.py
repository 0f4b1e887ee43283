"""Execution of a study: tunings, then the missing runs and calibrations."""

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from runner import store
from runner.base import progress
from runner.config.compose.composer import Composer
from runner.config.composed import CALIBRATION
from runner.papers.study.estimate import cost_line, counted, estimate_all, planned
from runner.papers.study.items import Way, listed, make_items
from runner.papers.study.results import Results
from runner.papers.study.study import Study
from runner.papers.study.tune import find_gains
from runner.papers.study.tunings import StudyTuning
from runner.simulation.provenance import portable_overrides
from runner.store import Calibration, Run
from runner.sweeps.check import check
from runner.sweeps.plan import Item


def make_all(
    study: Study, outputs: Path, overrides: Sequence[str] = (), command: str = "runner reproduce"
) -> tuple[Results[Run], Results[Calibration]]:
    """Execute the missing runs and calibrations of a study; return all by name.

    Gains that its runs take and that are not known are tuned at first.

    Args:
        study: The study.
        outputs: Folder in which they are stored.
        overrides: How they are made: keys of hydra.sweeper, sweep and limits.
        command: The command that executes and continues them.

    Raises:
        ConfigError: if one cannot be made, or all would cost too much; nothing has been started then.
        StoreError: if the disk does not take them.
        RunnerError: if an equation cannot be checked or typeset, or the
            Dask scheduler does not answer.
    """
    study.check_equations()
    way = Way(outputs, overrides, command, study.config_dirs)
    tunings = study.untuned()
    if tunings:
        _tell_estimate(study, tunings, way)
    study.take(find_gains(tunings, way))
    jobs, calibrations = study.jobs(), study.calibrations()
    made = make_items(_items(study), way, trace="all" if study.manifest.traces else "never")
    missing = {name: each.missing for name, each in made.items() if each.missing}
    finished = store.Finished(outputs)
    stored = {name: finished.open(made[name].place) for name in jobs if name not in missing}
    runs = {name: run.made_by(_command(study, jobs[name], run)) for name, run in stored.items()}
    found = {
        name: store.open_calibration(outputs / "calibrations" / made[name].place)
        for name in calibrations
        if name not in missing
    }
    not_run = {name: why for name, why in missing.items() if name in jobs}
    not_found = {name: why for name, why in missing.items() if name in calibrations}
    return study.results(runs, not_run), study.results(found, not_found)


def _tell_estimate(study: Study, tunings: Sequence[StudyTuning], way: Way) -> None:
    """Print what tunings take with the runs of their laws, before they are started."""
    progress.begin("estimating")
    counts = counted(study, tunings, {override for each in tunings for override in each.chosen})
    amounts = estimate_all(planned(counts, way), [*counts.values()])
    laws = list(dict.fromkeys(each.law for each in tunings))
    workers = Composer(way.config_dirs).sweeper([text for text in way.overrides if text.startswith("hydra.")]).workers
    print(f"runner: {cost_line(laws, amounts, workers)}, less where they are stored", file=sys.stderr)


def _command(study: Study, overrides: Sequence[str], run: Run) -> str:
    return shlex.join(["runner", *study.options(overrides), *portable_overrides(overrides, run.config)])


def count_missing(study: Study, outputs: Path) -> int:
    """Return the number of runs and calibrations of a study that are not stored."""
    names = check(listed(_items(study), Way(outputs), Composer(study.config_dirs))).names
    in_shards = store.Finished(outputs).places_of(names) >= 0
    left = {name for name, there in zip(names, in_shards.tolist(), strict=True) if not there}
    kept = ("runs/{}/metrics.json", "calibrations/{}/result.json")
    return sum(not any((outputs / place.format(name)).exists() for place in kept) for name in left)


def _items(study: Study) -> dict[str, Item]:
    items = {name: Item(own) for name, own in study.jobs().items()}
    return items | {name: Item(own, CALIBRATION) for name, own in study.calibrations().items()}
