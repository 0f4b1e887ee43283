"""Integration error of a difference: the compared runs on a finer step, with the same seeds.

PyBullet and MuJoCo runs are repeated with Runge-Kutta, and Runge-Kutta runs with half of their step. Both sides of a
comparison have similar errors if their motions are similar. The error of a difference is therefore not the error of
a run.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from runner.base import progress
from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.statistics.interval import SMALLEST_SAMPLE
from runner.store.axes import axes_of
from runner.store.drawn import draws_nothing
from runner.store.finished import finer_names, write_finer
from runner.store.run import Run
from runner.store.sweep import Sweep
from runner.sweeps.status import report_if_running

if TYPE_CHECKING:
    from runner.assembly.run_config import RunConfig

DRAWS = 8
"""Number of first repetitions to repeat: the integration error varies far less than the random draws."""

MOST_RUNS = 200
"""Largest number of runs to repeat; if there are more, none is repeated."""

_SEED = "seed"


def work_out_sweep(sweep: Sweep) -> None:
    """Store the metrics on a finer step for the cells of a sweep, if these can be compared and are not too many.

    Raises:
        StoreError: if a run is missing or damaged, or the result cannot be written.
    """
    if len(sweep.hashes) <= MOST_RUNS and any(axis.name != _SEED for axis in axes_of(sweep.overrides)[0]):
        with report_if_running(sweep):
            runs = list(sweep.runs())
        work_out(sweep.outputs, runs)


def work_out(outputs: Path, runs: Iterable[Run]) -> None:
    """Store the metrics on a finer step for some runs, unless they are already stored.

    Runs from another version of the runner or another robot file are left out. Nothing is stored if the runs draw
    something and have fewer repetitions and seeds than a comparison needs.

    Raises:
        StoreError: if a run is damaged, or the result cannot be written.
    """
    given = list(runs)
    draws = sum({int(run.config["seed"]): int(run.record["repetitions"]) for run in given}.values())
    known = finer_names(outputs)
    left = [run for run in given if run.hash not in known and run.status == "ok"]
    few = draws < SMALLEST_SAMPLE and not all(draws_nothing(run.config) for run in given)
    if few or len(given) > MOST_RUNS or not left:
        return
    progress.begin("trying a finer step", len(left), "runs")
    for run in left:
        made = _made(run)
        if made is not None:
            write_finer(outputs, run.hash, *made)
        progress.step()


def _made(run: Run) -> tuple[str, Mapping[str, FloatArray]] | None:
    """Return the reason if a run has no finer step, and its metrics on it; None if the run cannot be repeated."""
    # Imports of the simulator, which a comparison of runs with known errors does not need
    from runner.assembly.validation import validate
    from runner.simulation.run import simulate_blocks, threads_allowed
    from runner.sweeps.rerun import checked_config

    try:
        config = checked_config(run)
        if reason := _find_obstacle(config):
            return reason, {}
        resolved = _finer(run.config, config)
        result = simulate_blocks(validate(replace(run.composed, resolved=resolved)), threads_allowed())
    except RunnerError:
        return None
    if result is None:
        return "a part of it is not compiled", {}
    lost = np.full(resolved["repetitions"], np.inf)
    return "", {
        name: np.array(result.metrics[name].values, dtype=float) if name in result.metrics else lost
        for name in run.metrics
    }


def _find_obstacle(config: "RunConfig") -> str:
    """Return the reason why a run has no finer step; "" if it has one."""
    from runner.caveats.integration_error import COMPARED, PLANT, reason_not_comparable

    kind = config.plant.kind
    if reason := reason_not_comparable(config.environment.kind):
        return reason
    return "" if kind in COMPARED or kind.startswith(PLANT) else f"plant={kind} has no finer step"


def _finer(given: Mapping[str, Any], config: "RunConfig") -> dict[str, Any]:
    """Return the config of the same run on a finer step, with only the first repetitions."""
    from runner.caveats.integration_error import COMPARED, on_runge_kutta

    if config.plant.kind in COMPARED:
        resolved = on_runge_kutta(given)
    else:
        resolved = {**given, "plant": {**given["plant"], "step": config.timing.step / 2}}
    draws = 1 if draws_nothing(given) else DRAWS
    return {**resolved, "repetitions": min(int(given["repetitions"]), draws), "plant_error": False}
