"""How long jobs will take: estimated before they start, and shown while they run."""

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Self

from tqdm import tqdm

from runner import store
from runner.config.compose import Composed
from runner.config.validation import validate
from runner.execution import seconds_per_tick
from runner.store.atomic import write_atomically
from runner.store.seal import sealed_json
from runner.sweeps.deadline import TimeLimitError, deadline
from runner.sweeps.plan import Checked, Plan
from runner.sweeps.status import NOTE

_EVERY = 2.0  # s between two notes of the progress
_PROBES = 3  # cells that the first estimate is made from
_PROBED_WITHIN = 2.0  # s; what takes longer is told when its run is made
_FIXED = 0.010  # s that a job takes beside its ticks


class Progress:
    """A bar on the terminal, in ticks, and a note in the sweep's folder for `runner status`.

    Args:
        folder: The sweep's folder.
        jobs: Number of jobs to make.
        ticks: What they cost together.
        cost: Gives what one of them costs, by name.
    """

    def __init__(self, folder: Path, jobs: int, ticks: int, cost: Callable[[str], int]) -> None:
        self._folder, self._cost = folder, cost
        self._made, self._jobs = 0, jobs
        self._bar = tqdm(total=ticks, unit="tick", unit_scale=True, desc="running", disable=None, file=sys.stderr)
        self._began = self._noted = time.monotonic()

    def add(self, outcomes: Sequence[store.Outcome]) -> None:
        """Take note of jobs that ended."""
        self._made += len(outcomes)
        self._bar.set_postfix_str(f"{self._made} of {self._jobs}", refresh=False)
        self._bar.update(sum(self._cost(end.name) for end in outcomes))
        now = time.monotonic()
        if self._made and now - self._noted > _EVERY:
            self._noted = now
            write_atomically(self._folder / NOTE, sealed_json({"seconds_per_run": (now - self._began) / self._made}))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()


def estimate(plan: Plan, checked: Checked, cells: Sequence[int], ticks: int) -> float:
    """Return the CPU time that some cells will take, in s, from a few ticks of a few of their runs.

    Args:
        plan: The plan.
        checked: What its check gave.
        cells: The cells; in a tuning, one for each trial.
        ticks: What they cost together.
    """
    runs = [cell for cell in cells if cell not in checked.calibrations]
    chosen = sorted({runs[len(runs) * part // _PROBES] for part in range(_PROBES)}) if runs else []
    probed = [_probe(plan.composed(cell), checked.costs[cell]) for cell in chosen]
    per_tick = sum(probed) / len(probed) if probed else 0.0
    return _FIXED * len(cells) + per_tick * ticks


def _probe(composed: Composed, ticks: int) -> float:
    """Return the time for a tick of a run, in s."""
    config = validate(composed.resolved, composed.config_dirs)
    try:
        with deadline(_PROBED_WITHIN):
            return seconds_per_tick(config)
    except TimeLimitError:
        return (config.sweep.time_limit or _PROBED_WITHIN) / ticks
    except Exception:  # an error of a part is stored when its run is made
        return 0.0
