"""How long a sweep will take: estimated before it starts, and shown while it runs."""

import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Self

from tqdm import tqdm

from runner import store
from runner.assembly import assemble, make_encoders
from runner.config.compose import Composed
from runner.config.validation import validate
from runner.simulation import simulate
from runner.store.atomic import write_atomically
from runner.store.seal import sealed_json
from runner.sweeps.deadline import TimeLimitError, deadline
from runner.sweeps.plan import Plan
from runner.sweeps.status import NOTE

_EVERY = 2.0  # s between two notes of the progress
_PROBES = 3  # cells that the first estimate is made from
_PROBED_TICKS = 50
_PROBED_WITHIN = 2.0  # s; what takes longer is told when its run is made
_FIXED = 0.010  # s that a run takes beside its ticks


class Progress:
    """A bar on the terminal, and a note in the sweep's folder for `runner status`.

    Args:
        folder: The sweep's folder.
        total: Number of runs.
        done: Number of them that are stored already.
    """

    def __init__(self, folder: Path, total: int, done: int) -> None:
        self._folder, self._left, self._total = folder, total - done, total - done
        self._bar = tqdm(total=total, initial=done, unit="run", desc="running", disable=None, file=sys.stderr)
        self._began = self._noted = time.monotonic()

    def add(self, outcomes: Sequence[store.Outcome]) -> None:
        """Take note of runs that ended."""
        self._left -= len(outcomes)
        self._bar.update(len(outcomes))
        now = time.monotonic()
        if self._left < self._total and now - self._noted > _EVERY:
            self._noted = now
            seconds = (now - self._began) / (self._total - self._left)
            write_atomically(self._folder / NOTE, sealed_json({"seconds_per_run": seconds}))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()


def estimate(plan: Plan, cells: Sequence[int], workers: int) -> float:
    """Return how long some cells will take, in s, from a few ticks of a few of them."""
    chosen = {cells[len(cells) * part // _PROBES] for part in range(_PROBES)}
    return sum(map(_probe, map(plan.composed, chosen))) / len(chosen) * len(cells) / max(workers, 1)


def _probe(composed: Composed) -> float:
    config = validate(composed.resolved, composed.config_dirs)
    whole = assemble(config)
    part = replace(whole, ticks=min(whole.ticks, _PROBED_TICKS))
    try:
        with deadline(_PROBED_WITHIN):
            simulate(part, make_encoders(config, part, 0))
            start = time.perf_counter()
            simulate(part, make_encoders(config, part, 0))
        per_tick = (time.perf_counter() - start) / (part.ticks + 1)
        return _FIXED + per_tick * whole.ticks * config.settings.repetitions
    except TimeLimitError:
        return config.sweep.time_limit or _PROBED_WITHIN
    except Exception:  # an error of a part is stored when its run is made
        return _FIXED
    finally:
        whole.plant.close()
