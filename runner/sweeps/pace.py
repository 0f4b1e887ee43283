"""How long jobs will take: estimated before they start, and noted while they run."""

import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runner.batch_jobs import seconds_together
from runner.config.compose import Composed
from runner.config.validation import validate
from runner.job import seconds_per_tick
from runner.store.atomic import write_atomically
from runner.store.seal import sealed_json
from runner.sweeps.deadline import TimeLimitError, deadline
from runner.sweeps.plan import Checked, Plan
from runner.sweeps.status import NOTE

_EVERY = 2.0  # s between two notes of the pace
START_UP = 3.0
"""CPU time that a worker process takes until its first run, in s."""
_PROBES = 3  # cells that the first estimate is made from, of each power of ten of ticks
_PROBED_WITHIN = 2.0  # s; what takes longer is told when its run is made
_FIXED = 0.010  # s that a job takes beside its ticks
_FIXED_TOGETHER = 0.0002  # s, of runs that are simulated together and keep no trace
_TICKS_TOGETHER = 20_000  # of runs that are simulated together for the first estimate


class Pace:
    """A note in a sweep's folder for `runner status`: how long a job takes.

    Args:
        folder: The sweep's folder.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._made = folder, 0
        self._began = self._noted = time.monotonic()

    def add(self, jobs: int) -> None:
        """Take note of a number of jobs that ended."""
        self._made += jobs
        now = time.monotonic()
        if self._made and now - self._noted > _EVERY:
            self._noted = now
            write_atomically(self._folder / NOTE, sealed_json({"seconds_per_run": (now - self._began) / self._made}))


def estimate(plan: Plan, checked: Checked, cells: NDArray[np.intp], kept: float) -> float:
    """Return the CPU time that some cells will take, in s, from a few ticks of a few of their runs.

    Args:
        plan: The plan.
        checked: What its check gave.
        cells: The cells, shape (n,); in a tuning, one for each trial.
        kept: Share of the runs that keep their trace.
    """
    runs = np.setdiff1d(cells, list(checked.calibrations), assume_unique=True) if checked.calibrations else cells
    # Runs of very many ticks, such as those of a thousand repetitions, may have another pace than the others.
    sizes = np.floor(np.log10(np.maximum(checked.costs[runs], 1)))
    others = _FIXED * (len(cells) - len(runs))
    return others + sum(_seconds(plan, checked, runs[sizes == size], kept) for size in np.unique(sizes))


def _seconds(plan: Plan, checked: Checked, runs: NDArray[np.intp], kept: float) -> float:
    """Return the CPU time of runs of about as many ticks, in s."""
    chosen = sorted({int(runs[len(runs) * part // _PROBES]) for part in range(_PROBES)})
    probed = [_probe(plan.composed(cell), int(checked.costs[cell])) for cell in chosen]
    per_tick, together = np.mean(probed, axis=0).tolist()
    in_shards = together * (1.0 - kept) * len(runs)
    fixed = _FIXED * (len(runs) - in_shards) + _FIXED_TOGETHER * in_shards
    return float(fixed + per_tick * checked.costs[runs].sum())


def _probe(composed: Composed, ticks: int) -> tuple[float, bool]:
    """Return the time for a tick of a run, in s, and whether it can be simulated together with others."""
    config = validate(composed.resolved, composed.config_dirs)
    together = False
    try:
        with deadline(_PROBED_WITHIN):
            per_tick = seconds_together((config, composed), _TICKS_TOGETHER)
            together = per_tick is not None
            return (seconds_per_tick(config, composed) if per_tick is None else per_tick), together
    except TimeLimitError:
        return (config.sweep.time_limit or _PROBED_WITHIN) / ticks, together
    except Exception:  # an error of a part is stored when its run is made
        return 0.0, together
