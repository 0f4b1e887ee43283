"""Result of a run, before it is stored."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from runner.base.trace import Failure, Trace
from runner.metrics.caveats import Found
from runner.metrics.plant_error import PlantError
from runner.metrics.summary import Summary


@dataclass(frozen=True)
class RunResult:
    """All that a job leaves to be stored.

    Attributes:
        resolved: The resolved config.
        urdf: The URDF's text.
        trace: The trace of repetition 0.
        metrics: Metrics over the repetitions.
        caveats: Why they may not be what they seem.
        repetitions: Number of repetitions.
        failure: The first failure and its repetition, or None.
        timing: What a clock measured.
        provenance: Commit, versions, machine, seed, command.
        plant_error: What the plant's step is worth, where that was asked for and can be.
    """

    resolved: Mapping[str, Any]
    urdf: str
    trace: Trace
    metrics: Mapping[str, Summary]
    caveats: Found
    repetitions: int
    failure: tuple[int, Failure] | None
    timing: Mapping[str, float | None]
    provenance: Mapping[str, Any]
    plant_error: PlantError | None = None


def timing(
    tick_seconds: np.ndarray, wall_s: float, cpu_s: float, law_seconds: np.ndarray | None = None
) -> dict[str, float | None]:
    """Return the timing record.

    Args:
        tick_seconds: Time of every tick, shape (N,), in s; a run that failed at once has no tick.
        wall_s: Wall-clock time of the whole, in s.
        cpu_s: CPU time of it, in s.
        law_seconds: What the control loops took in each tick, shape (N,), in s; None where nobody can tell.
    """
    median, p99 = np.percentile(tick_seconds, [50, 99]).tolist() if len(tick_seconds) else (None, None)
    record = {"tick_time_median": median, "tick_time_p99": p99, "wall_s": wall_s, "cpu_s": cpu_s}
    if law_seconds is not None and len(law_seconds):
        names = ("law_time_median", "law_time_p99", "law_time_p999", "law_time_max")
        record |= dict(zip(names, np.percentile(law_seconds, [50, 99, 99.9, 100]).tolist(), strict=True))
        record["load_average"] = os.getloadavg()[0]
    return record
