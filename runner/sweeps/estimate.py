"""Run times of jobs: estimates before the start, and measurements during a sweep."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from runner.assembly.validation import validate
from runner.base.atomic import write_atomically
from runner.base.quantities import format_duration
from runner.config.composed import Composed
from runner.simulation.tick_time import PROBED_TICKS, seconds_per_tick, seconds_together
from runner.store.seal import sealed_json
from runner.sweeps.check import Checked
from runner.sweeps.deadline import TimeLimitError, deadline
from runner.sweeps.plan import Plan
from runner.sweeps.status import NOTE

_EVERY = 2.0  # s between two updates of the pace
START_UP = 1.0
"""CPU time that a worker process takes until its first run, in s."""
_PROBES = 3  # cells behind the first estimate, for each power of ten of ticks
_PROBED_WITHIN = 2.0  # s, for the ticks of a probe
_FIXED = 0.010  # s that a job takes in addition to its ticks
_FIXED_TOGETHER = 0.0002  # s, for runs that are simulated together and keep no trace
_TICKS_TOGETHER = 20_000  # most ticks of runs that are simulated together for the first estimate


Known = Literal["about", "more than", "up to"]


@dataclass(frozen=True)
class Estimate:
    """Estimated CPU time.

    Attributes:
        seconds: The time, in s.
        known: Kind of the estimate: "about" the time; "more than" the time, if a few ticks exceeded the time of a
            probe; or "up to" the time, if the time limit of the runs bounds it.
    """

    seconds: float
    known: Known = "about"

    def in_words(self, processes: int, together: int, more: float = 0.0) -> str:
        """Return the duration as a message.

        Args:
            processes: Number of processes.
            together: Number of processes that run at the same time.
            more: Additional time that the processes do not share, in s.
        """
        several = "es" if processes > 1 else ""
        return f"{self.known} {format_duration(more + self.seconds / together)} on {processes} process{several}"


class Pace:
    """Record of the time for a job in a sweep's folder, for `runner status`.

    Args:
        folder: The sweep's folder.
        clock: Function that returns the time, in s.
    """

    def __init__(self, folder: Path, clock: Callable[[], float] = time.monotonic) -> None:
        self._folder, self._made, self._clock = folder, 0, clock
        self._began = self._noted = clock()

    def add(self, jobs: int) -> None:
        """Count a number of finished jobs."""
        self._made += jobs
        now = self._clock()
        if self._made and now - self._noted > _EVERY:
            self._noted = now
            write_atomically(self._folder / NOTE, sealed_json({"seconds_per_run": (now - self._began) / self._made}))


def estimate(plan: Plan, checked: Checked, cells: NDArray[np.intp], kept: float, until: float = math.inf) -> Estimate:
    """Return the estimated CPU time of some cells, measured on a few ticks of a few of their runs.

    Args:
        plan: The plan.
        checked: Result of the check of the plan.
        cells: The cells, shape (n,); in a tuning, one for each trial.
        kept: Fraction of the runs that keep their trace.
        until: Time of `time.monotonic` from which a TimeLimitError of the caller's deadline is passed on, in s.
    """
    runs = np.setdiff1d(cells, list(checked.calibrations), assume_unique=True) if checked.calibrations else cells
    # Runs with very many ticks, such as a thousand repetitions, may need another time for a tick than the others.
    sizes = np.floor(np.log10(np.maximum(checked.costs[runs], 1)))
    found = [_estimate_alike(plan, checked, runs[sizes == size], kept, until) for size in np.unique(sizes)]
    seconds = _FIXED * (len(cells) - len(runs)) + sum(each.seconds for each in found)
    return Estimate(seconds, next((each.known for each in found if each.known != "about"), "about"))


def _estimate_alike(plan: Plan, checked: Checked, runs: NDArray[np.intp], kept: float, until: float) -> Estimate:
    """Return the CPU time of runs with a similar number of ticks, from the median of a few."""
    chosen = sorted({int(runs[len(runs) * part // _PROBES]) for part in range(_PROBES)})
    most = int(min(_TICKS_TOGETHER, checked.costs[runs].sum()))  # more would take longer than the runs themselves
    probed = sorted(_probe(plan.composed(cell), int(checked.costs[cell]), most, until) for cell in chosen)
    per_tick, together, known = probed[len(probed) // 2]
    in_shards = (1.0 - kept) * len(runs) if together else 0.0
    fixed = _FIXED * (len(runs) - in_shards) + _FIXED_TOGETHER * in_shards
    limit = checked.first.sweep.time_limit
    if known == "more than" and limit is not None:
        return Estimate(fixed + limit * len(runs), "up to")
    return Estimate(float(fixed + per_tick * checked.costs[runs].sum()), known)


def _probe(composed: Composed, ticks: int, ticks_together: int, until: float) -> tuple[float, bool, Known]:
    """Return the time for a tick of a run, in s, if the run can be simulated together with others, and its kind.

    Assembly and compilation are not counted because they happen once.
    """
    config = validate(composed)
    probed = max(ticks, ticks_together)
    try:
        per_tick = seconds_together(config, ticks_together, deadline(_PROBED_WITHIN))
        if per_tick is not None:
            return per_tick, True, "about"
        probed = min(ticks, PROBED_TICKS)
        return seconds_per_tick(config, deadline(_PROBED_WITHIN)), False, "about"
    except TimeLimitError:
        if time.monotonic() >= until:
            raise
        return _PROBED_WITHIN / probed, False, "more than"
    except Exception:  # the error of a component is stored with its run
        return 0.0, False, "about"
