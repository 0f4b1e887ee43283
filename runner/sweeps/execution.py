"""Execution of one run: check of a composed config, simulation and storage, or reuse of a stored run."""

import sys
from collections.abc import Sequence
from pathlib import Path

from runner import store
from runner.base import progress
from runner.base.progress.stages import SIMULATING, SOON
from runner.base.progress.ticks import counter
from runner.config.compose.compose import Composed, compose
from runner.config.limits import check_cpu_time
from runner.config.validation import validate
from runner.simulation.batch_blocks import threads_allowed
from runner.store.latest import note
from runner.sweeps.job import seconds_per_tick, simulate_job

_SURELY_ALLOWED = 200_000  # ticks, which take minutes at most


def run(*overrides: str, config_dirs: Sequence[Path] = ()) -> store.Run:
    """Do what `runner OVERRIDES` does, from Python.

    Args:
        overrides: Hydra overrides, such as "robot=macro" and "trajectory=goal".
        config_dirs: Config folders of the user's, searched before ours.

    Returns:
        The stored run, with `.metrics`, `.trace` and `.folder`; found stored, it is not simulated again.

    Raises:
        ConfigError: for a config that cannot be run; lists all its problems.
        StoreError: if the outputs folder cannot be written.
    """
    return execute(compose(overrides, config_dirs))


def execute(composed: Composed) -> store.Run:
    """Run a composed config, or return its stored run; see `run`."""
    return find_or_make(composed)[0]


def find_or_make(composed: Composed) -> tuple[store.Run, bool]:
    """Run a composed config, or find its stored run; return the run, and whether it was made."""
    config = validate(composed.resolved, composed.config_dirs)
    outputs = Path(config.settings.outputs)
    name = store.run_hash(composed.resolved, config.arm.urdf)
    try:
        stored = store.find_run(outputs, name)
    except store.DamagedError as error:
        print(f"runner: {error}; making it again", file=sys.stderr)
        stored = None
    if stored is not None:
        note(stored.folder)
        return store.judge_run(stored, config.spec.metrics), False
    ticks, seconds = config.timing.ticks * config.settings.repetitions, None
    if ticks > _SURELY_ALLOWED:
        seconds = seconds_per_tick(config, composed) * ticks
        check_cpu_time(config.limits, seconds, 1)
    store.prepare(outputs)
    progress.begin(SIMULATING, seconds, ticks, "ticks", counter())
    result = simulate_job(config, composed, threads_allowed())
    progress.begin("storing the run", SOON)
    made = store.write_run(outputs, name, result)
    note(made.folder)
    return made, True
