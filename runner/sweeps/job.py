"""A job: one run or one calibration, from its composed config to its stored result."""

import sys
from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar

from runner import store
from runner.assembly.run_config import RunConfig
from runner.assembly.run_cost import check_cpu_time
from runner.assembly.validation import validate
from runner.base import progress
from runner.base.ticks import counter
from runner.config.compose.compose import compose
from runner.config.composed import CALIBRATION, Composed
from runner.simulation.calibration import TICKS, simulate_calibration
from runner.simulation.calibration_config import CalibrationConfig, validate_calibration
from runner.simulation.results import RunResult
from runner.simulation.run import simulate_run, threads_allowed
from runner.simulation.tick_time import seconds_per_tick
from runner.store.kinds import note

_SURELY_ALLOWED = 200_000  # ticks, which take minutes at most

Result = TypeVar("Result")
StoredJob = TypeVar("StoredJob", store.Run, store.Calibration)


class Job(ABC, Generic[Result, StoredJob]):
    """One run or calibration whose config has been checked.

    Attributes:
        activity: Word for the progress bar.
        name: Hash of the run or calibration.
        outputs: The outputs folder.
        ticks: Number of ticks, summed over the repetitions; for a calibration, of a run that takes as long.
    """

    activity: str

    def __init__(self, config: RunConfig | CalibrationConfig, ticks: int) -> None:
        self.name = store.run_hash(config.resolved, config.arm.urdf)
        self.outputs = Path(config.settings.outputs)
        self.ticks = ticks * config.settings.repetitions

    def check_cost(self) -> None:
        """Raise a ConfigError if the job exceeds the limit of CPU time."""
        return

    @abstractmethod
    def find(self, outputs: Path) -> StoredJob | None:
        """Return the stored result, or None if there is none.

        Raises:
            DamagedError: if the stored result is damaged.
        """

    @abstractmethod
    def simulate(self, threads: int = 1) -> Result:
        """Return the result of all repetitions, simulated on a number of threads."""

    @abstractmethod
    def write(self, outputs: Path, result: Result) -> StoredJob:
        """Store the result."""


class RunJob(Job[RunResult, store.Run]):
    """One run; see Job."""

    activity = "simulating"

    def __init__(self, config: RunConfig) -> None:
        super().__init__(config, config.timing.ticks)
        self.config = config

    def find(self, outputs: Path) -> store.Run | None:
        """Return the stored run; its bounds are those of the config."""
        stored = store.find_run(outputs, self.name)
        return None if stored is None else store.judge_run(stored, self.config.spec.metrics)

    def check_cost(self) -> None:
        """Raise a ConfigError if the run exceeds the limit of CPU time."""
        if self.ticks > _SURELY_ALLOWED:
            check_cpu_time(self.config.limits, seconds_per_tick(self.config) * self.ticks, 1)

    def simulate(self, threads: int = 1) -> RunResult:
        """Return the result of the run."""
        return simulate_run(self.config, threads)

    def write(self, outputs: Path, result: RunResult) -> store.Run:
        """Store the run."""
        from runner.sweeps.records import write_run

        return write_run(outputs, self.name, result)


class CalibrationJob(Job[dict[str, Any], store.Calibration]):
    """One calibration; see Job."""

    activity = "calibrating"

    def __init__(self, config: CalibrationConfig) -> None:
        super().__init__(config, TICKS)
        self.config = config

    def find(self, outputs: Path) -> store.Calibration | None:
        """Return the stored calibration."""
        return store.find_calibration(outputs, self.name)

    def simulate(self, threads: int = 1) -> dict[str, Any]:
        """Return the record of the calibration, which uses one thread."""
        return simulate_calibration(self.config)

    def write(self, outputs: Path, result: dict[str, Any]) -> store.Calibration:
        """Store the calibration."""
        return store.write_calibration(outputs, self.name, self.config.resolved, self.config.arm.urdf, result)


def check_job(composed: Composed) -> RunJob | CalibrationJob:
    """Check a composed config; return its job.

    Raises:
        ConfigError: with every problem found.
    """
    if composed.root == CALIBRATION:
        return CalibrationJob(validate_calibration(composed))
    return RunJob(validate(composed))


def perform(job: Job[Result, StoredJob]) -> tuple[StoredJob, bool]:
    """Simulate and store a job, unless it is stored already; return the stored result, and True if it is new.

    Raises:
        ConfigError: if the job exceeds the limit of CPU time.
        StoreError: if the outputs folder cannot be written.
    """
    try:
        stored = job.find(job.outputs)
    except store.DamagedError as error:
        print(f"runner: {error}; making it again", file=sys.stderr)
        stored = None
    new = stored is None
    if stored is None:
        job.check_cost()
        store.prepare(job.outputs)
        progress.begin(job.activity, job.ticks, "ticks", counter())
        result = job.simulate(threads_allowed())
        progress.begin("storing the result")
        stored = job.write(job.outputs, result)
    note(stored.folder)
    return stored, new


def run(*overrides: str, config_dirs: Sequence[Path] = ()) -> store.Run:
    """Simulate `runner OVERRIDES`, or return the stored run.

    Args:
        overrides: Hydra overrides, such as "robot=macro" and "trajectory=goal".
        config_dirs: User config folders, searched before the built-in ones.

    Raises:
        ConfigError: if the config cannot be run; the error lists all its problems.
        StoreError: if the outputs folder cannot be written.
    """
    return perform(RunJob(validate(compose(overrides, config_dirs))))[0]


def calibrate(*overrides: str, config_dirs: Sequence[Path] = ()) -> store.Calibration:
    """Simulate `runner calibrate OVERRIDES`, or return the stored calibration; see `run`."""
    return perform(CalibrationJob(validate_calibration(compose(overrides, config_dirs, CALIBRATION))))[0]
