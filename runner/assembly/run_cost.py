"""Memory and CPU time of runs, estimated and checked against the limits before the first run."""

import math

from runner.assembly.timing import Timing
from runner.base.errors import ConfigError
from runner.base.limits import half_of_memory
from runner.config.limits import LimitsConfig
from runner.robots.robot import Robot

TICKS_AT_ONCE = 1_000_000
"""Ticks of a run's repetitions in memory at the same time; more if a single repetition has more."""

_GB = 1e9  # bytes
_NUMBER = 8  # bytes
# Numbers that a run keeps for each tick, including its stored trace and the metrics' arrays: measured, rounded up.
_OF_EACH_TICK, _OF_EACH_JOINT, _OF_CONTACT = 24, 13, 75
# Metrics of an arm, of each joint, and of each stage below another. Bytes of each metric in a repetition: of its
# gathered and of its stored value.
_METRICS, _METRICS_OF_JOINT, _METRICS_OF_STAGE = 22, 4, 9
_OF_EACH_METRIC = 12


def memory_of_run(arm: Robot, ticks: int, repetitions: int, has_contact: bool) -> float:
    """Return the memory that a run needs in addition to the program, in bytes.

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
    """Return the memory for the metrics of a repetition, in bytes."""
    metrics = _METRICS + _METRICS_OF_JOINT * arm.model.nq + _METRICS_OF_STAGE * (len(arm.stages) - 1)
    return float(_OF_EACH_METRIC * metrics)


def check_memory(limits: LimitsConfig, arm: Robot, timing: Timing, repetitions: int, has_contact: bool) -> None:
    """Check that a run fits into memory; see memory_of_run.

    Raises:
        ConfigError: if it needs more than `limits.memory`; gives the estimate and the number of repetitions that fit.
    """
    needed, half = memory_of_run(arm, timing.ticks, repetitions, has_contact), half_of_memory()
    own = math.inf if limits.memory is None else _GB * limits.memory
    if needed > min(own, half):
        fit = repetitions + int((min(own, half) - needed) // _of_repetition(arm))
        fitting = f", in which {fit} repetitions fit" if fit > 0 else ""
        length = f"{timing.ticks * timing.tick:.3g} s ({timing.ticks:.3g} ticks of {timing.tick:g} s"
        allowed, more = (f"{own / _GB:g} GB", ", or set limits.memory") if own < half else (_told(half), "")
        raise ConfigError(
            f"limits.memory: a run of {length}, repetitions: {repetitions}) would take about {needed / _GB:.3g} "
            f"GB; allowed: {allowed}{fitting}; shorten duration or trajectory.duration, ask for fewer "
            f"repetitions{more}"
        )


def _told(half: float) -> str:
    return f"{half / _GB:.3g} GB, half of this machine's memory"


def check_memory_together(needed: float, runs: int) -> None:
    """Check that simultaneous runs fit into half of the machine's memory.

    Args:
        needed: Memory of the largest run, in bytes.
        runs: Number of simultaneous runs.

    Raises:
        ConfigError: if they do not; gives the estimate and the number of runs that fit.
    """
    half = half_of_memory()
    if runs * needed > half:
        raise ConfigError(
            f"hydra.sweeper.workers: {runs} runs at a time, of {needed / _GB:.3g} GB each, would take about "
            f"{runs * needed / _GB:.3g} GB; allowed: {_told(half)}, in which {int(half // needed)} fit"
        )


def check_cpu_time(limits: LimitsConfig, seconds: float, runs: int, known: str = "about") -> None:
    """Check that runs do not take too much CPU time.

    Args:
        limits: The limits.
        seconds: Estimated CPU time, in s.
        runs: Number of runs.
        known: Kind of the estimate: "about", "more than" or "up to".

    Raises:
        ConfigError: if the estimate is above `limits.cpu_hours`; gives the estimate.
    """
    hours = seconds / 3600.0
    if limits.cpu_hours is not None and hours > limits.cpu_hours:
        what = f"{runs} runs" if runs > 1 else "the run"
        raise ConfigError(
            f"limits.cpu_hours: {what} would take {known} {hours:.3g} hours of CPU time; allowed: "
            f"{limits.cpu_hours:g}; ask for less, or set limits.cpu_hours"
        )
