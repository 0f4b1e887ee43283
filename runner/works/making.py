"""The runs and calibrations of a work, made by the engine of sweeps where they are not stored yet."""

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from runner import store
from runner.calibration_job import CALIBRATION
from runner.provenance import settled
from runner.reporting.job import Made
from runner.store import Calibration, Run
from runner.sweeps.listed import Item, Listed
from runner.sweeps.loading import Loader
from runner.sweeps.plan import check
from runner.sweeps.run import Engine, run_sweep
from runner.works.work import Work


def make_all(
    work: Work, outputs: Path, overrides: Sequence[str] = (), command: str = "runner reproduce"
) -> tuple[Made[Run], Made[Calibration]]:
    """Make the runs and calibrations of a work that are not stored yet; return all by name.

    Args:
        work: The work.
        outputs: Folder in which they are stored.
        overrides: How they are made: keys of hydra.sweeper, sweep and limits.
        command: The command that makes them and goes on with it.

    Raises:
        ConfigError: if one cannot be made, or all would cost too much; nothing has been started then.
        StoreError: if the disk does not take them.
        RunnerError: if another sweep is at work in the same folder, or the Dask scheduler does not answer.
    """
    jobs, calibrations = work.jobs(), work.calibrations()
    items = _items(work)
    loader = Loader(work.config_dirs)
    sweeper = loader.sweeper([text for text in overrides if text.startswith("hydra.")])
    plan = _plan(items, outputs, overrides, loader)
    ended = run_sweep(plan, Engine(sweeper.workers, sweeper.address), command, accept_cut_short=False)
    places = dict(zip(items, ended.names, strict=True))
    ends = {name: ended.ends.get(place) for name, place in places.items()}
    missing = {name: "not begun" for name, end in ends.items() if end is None}
    missing |= {name: end.failure for name, end in ends.items() if end is not None and end.cut_short}
    stored = {name: store.open_run(outputs / "runs" / places[name]) for name in jobs if name not in missing}
    runs = {name: run.made_by(_command(work, jobs[name].overrides, run)) for name, run in stored.items()}
    found = {
        name: store.open_calibration(outputs / "calibrations" / places[name])
        for name in calibrations
        if name not in missing
    }
    return (
        Made(runs, {name: why for name, why in missing.items() if name in jobs}, work.dropped()),
        Made(found, {name: why for name, why in missing.items() if name in calibrations}, work.dropped()),
    )


def _command(work: Work, overrides: Sequence[str], run: Run) -> str:
    return shlex.join(["runner", *work.options(overrides), *settled(overrides, run.config)])


def count_missing(work: Work, outputs: Path) -> int:
    """Return how many runs and calibrations of a work are not stored."""
    names = set(check(_plan(_items(work), outputs, (), Loader(work.config_dirs))).names)
    kept = ("runs/{}/metrics.json", "calibrations/{}/result.json")
    return sum(not any((outputs / place.format(name)).exists() for place in kept) for name in names)


def _items(work: Work) -> dict[str, Item]:
    items = {name: Item(job.overrides) for name, job in work.jobs().items()}
    return items | {name: Item(own, CALIBRATION) for name, own in work.calibrations().items()}


def _plan(items: Mapping[str, Item], outputs: Path, overrides: Sequence[str], loader: Loader) -> Listed:
    shared = [text for text in overrides if not text.startswith("hydra.")]
    return Listed(items, [*shared, "sweep.trace=all", f"outputs={outputs}"], loader)
