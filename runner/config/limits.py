"""Limits of CPU time and memory, estimates that are checked before memory is allocated, and config of a sweep."""

import math
from typing import Literal

from pydantic import PositiveFloat, PositiveInt

from runner.base.errors import ConfigError
from runner.base.limits import half_of_memory
from runner.config.timing import Timing
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import Seconds

_GB = 1e9  # bytes
_NUMBER = 8  # bytes
# Numbers that a run keeps of each tick, its stored trace and the metrics' arrays included: measured, rounded up.
_OF_EACH_TICK, _OF_EACH_JOINT, _OF_CONTACT = 24, 13, 75
# Metrics of an arm, of each of its joints, and of each stage that carries another; and bytes of each in a repetition:
# as it is gathered, and as it is stored.
_METRICS, _METRICS_OF_JOINT, _METRICS_OF_STAGE = 22, 4, 9
_OF_EACH_METRIC = 12
TICKS_AT_ONCE = 1_000_000
"""Ticks of the repetitions of a run that are in memory at the same time; more where one alone has more."""


class LimitsConfig(StrictModel):
    """Limits of what a command may cost; an estimate above one stops it before it begins.

    Attributes:
        cpu_hours: Largest CPU time of all runs of a command together, in hours; None for no limit.
        memory: Largest memory of one run, in GB (10^9 bytes); never more than half of the machine's, as for None.
    """

    cpu_hours: PositiveFloat | None
    memory: PositiveFloat | None


class SweepConfig(StrictModel):
    """How the runs of a sweep are kept, and what happens to those that fail.

    Attributes:
        trace: Which runs keep their trace, and with it a folder of their own: all, the failed ones and one in a
            hundred, some 200 at most (sample), the failed ones, or none; auto is all up to some thousand runs, sample
            above.
        retry: Whether runs that failed in an earlier sweep are simulated again.
        on_failure: What the first failed run does to the rest of the sweep.
        attempts: How often a run is tried that was cut short: by its time limit, an error, or a worker's death.
        time_limit: Longest wall-clock time of a run, in s, after which it is interrupted; None for no limit.
    """

    trace: Literal["auto", "all", "sample", "failed", "never"]
    retry: Literal["none", "failed"]
    on_failure: Literal["continue", "stop"]
    attempts: PositiveInt
    time_limit: Seconds[PositiveFloat | None]


def memory_of_run(arm: Robot, ticks: int, repetitions: int, has_contact: bool) -> float:
    """Return the memory that a run takes beside the program, in bytes.

    Args:
        arm: The robot.
        ticks: Number of control ticks.
        repetitions: Number of repetitions.
        has_contact: True if the tip may touch something, or if a controller uses the external wrench.
    """
    numbers = _OF_EACH_TICK + _OF_EACH_JOINT * arm.model.nq + (_OF_CONTACT if has_contact else 0)
    at_once = max(ticks, min(ticks * repetitions, TICKS_AT_ONCE))
    return _NUMBER * numbers * at_once + _of_repetition(arm) * repetitions


def _of_repetition(arm: Robot) -> float:
    """Return the memory that the metrics of a repetition take, in bytes."""
    metrics = _METRICS + _METRICS_OF_JOINT * arm.model.nq + _METRICS_OF_STAGE * (len(arm.stages) - 1)
    return float(_OF_EACH_METRIC * metrics)


def check_memory(limits: LimitsConfig, arm: Robot, timing: Timing, repetitions: int, has_contact: bool) -> None:
    """Check that a run fits into memory; see memory_of_run.

    Raises:
        ConfigError: if it would take more than `limits.memory`; gives the estimate, and how many repetitions would fit.
    """
    needed, half = memory_of_run(arm, timing.ticks, repetitions, has_contact), half_of_memory()
    own = math.inf if limits.memory is None else _GB * limits.memory
    if needed > min(own, half):
        fit = repetitions + int((min(own, half) - needed) // _of_repetition(arm))
        fitting = f", in which {fit} repetitions fit" if fit > 0 else ""
        length = f"{timing.ticks * timing.tick:.3g} s ({timing.ticks:.3g} ticks of {timing.tick:g} s"
        allowed, more = (f"{own / _GB:g} GB", ", or set limits.memory") if own < half else (_told(half), "")
        raise ConfigError(
            [
                f"limits.memory: a run of {length}, repetitions: {repetitions}) would take about {needed / _GB:.3g} "
                f"GB; allowed: {allowed}{fitting}; shorten duration or trajectory.duration, ask for fewer "
                f"repetitions{more}"
            ]
        )


def _told(half: float) -> str:
    return f"{half / _GB:.3g} GB, half of this machine's memory"


def check_memory_together(needed: float, runs: int) -> None:
    """Check that runs at a time, the largest of which needs so many bytes, fit into half of the machine's memory.

    Raises:
        ConfigError: if they do not; gives the estimate, and how many would fit.
    """
    half = half_of_memory()
    if runs * needed > half:
        raise ConfigError(
            [
                f"hydra.sweeper.workers: {runs} runs at a time, of {needed / _GB:.3g} GB each, would take about "
                f"{runs * needed / _GB:.3g} GB; allowed: {_told(half)}, in which {int(half // needed)} fit"
            ]
        )


def check_cpu_time(limits: LimitsConfig, seconds: float, runs: int, known: str = "about") -> None:
    """Check that what is to be computed does not take too long.

    Args:
        limits: The limits.
        seconds: CPU time that it takes, as estimated, in s.
        runs: Number of runs.
        known: What is known of the time: "about" that, "more than" that or "up to" that.

    Raises:
        ConfigError: if it is more than `limits.cpu_hours`; gives the estimate.
    """
    hours = seconds / 3600.0
    if limits.cpu_hours is not None and hours > limits.cpu_hours:
        what = f"{runs} runs" if runs > 1 else "the run"
        raise ConfigError(
            [
                f"limits.cpu_hours: {what} would take {known} {hours:.3g} hours of CPU time; allowed: "
                f"{limits.cpu_hours:g}; ask for less, or set limits.cpu_hours"
            ]
        )
