"""Tunings of a study: trials as runs, and the resulting gains."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, takewhile
from typing import Any

from runner import store
from runner.base.dotted_keys import get
from runner.base.errors import RunnerError
from runner.config.compose.composer import Composer
from runner.papers.study.grid import Overrides
from runner.papers.study.items import Way, make_items
from runner.papers.study.tunings import Gains, StudyTuning, key_of
from runner.store import Run
from runner.sweeps.plan import Grid, Item
from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, Trial, best
from runner.sweeps.tuning.sampler import make_optuna_trial, propose

ROUNDS = 3
"""A half of the trials is spread over the ranges; earlier trials determine each half of the rest."""

_GROWS = "its error grows"
_GROWN = 1.1  # last error over an earlier one; what differs between periods by noise is less
_ERROR = "rms_tracking_error"
_SETTLED = (8, 16)  # periods after which no error is to grow


@dataclass
class _Search:
    """One of the tunings of a law, and its trials.

    Attributes:
        tuning: What is tuned.
        seed: Seed of the search and of its runs.
        keys: The keys, with their ranges.
        start: Their values before.
        trials: The trials that ended.
        proven: Numbers of the trials that are stable in their longer runs.
    """

    tuning: StudyTuning
    seed: int
    keys: Sequence[TunedKey]
    start: Mapping[str, float]
    trials: list[Trial] = field(default_factory=list)
    proven: set[int] = field(default_factory=set)

    @property
    def objective(self) -> Objective:
        """Metric to minimize."""
        return Objective(self.tuning.minimize, "minimize")

    def proposed(self, number: int) -> list[Mapping[str, float]]:
        """Return the values to try in a round, which is counted from 0. The values before come first."""
        if not self.keys:
            return [{}] if number == 0 else []
        most, spread = self.tuning.trials, self.tuning.trials // 2
        until = most if number == ROUNDS - 1 else spread + (most - spread) // (ROUNDS - 1) * number
        history = [make_optuna_trial(self.keys, trial) for trial in self.trials]
        chosen: list[Mapping[str, float]] = [] if history else [self.start]
        while len(history) + len(chosen) < until:
            chosen.append(propose(self.keys, [self.objective], history, chosen, self.seed, spread))
        return chosen

    def item(self, params: Mapping[str, float], overrides: Overrides) -> Item:
        """Return a run of a trial. Its seed is none of those of the runs that are judged."""
        chosen = (key.override(params[key.name]) for key in self.keys)
        return Item((*overrides, f"seed={self.seed}", *chosen))

    def take(self, params: Mapping[str, float], run: Run | None) -> None:
        """Take a trial that ended."""
        failure = _failure(run, self.tuning.bounds)
        value = None if run is None or failure else self.objective.read(run)
        if value is None:
            self.trials.append(Trial(params, (self.objective.worst,), "", failure or "beyond every number"))
        else:
            self.trials.append(Trial(params, (value,), "", ""))

    @property
    def best(self) -> int | None:
        """Number of the best trial; None where all failed."""
        return next(iter(best(self.trials, [self.objective])), None)

    def unproven(self, most: int) -> list[int]:
        """Return the numbers of the best trials up to a stable one, where the longer runs of the best are not known."""
        if not self.tuning.longer or self.best is None or self.best in self.proven:
            return []
        good = [number for number, trial in enumerate(self.trials) if not trial.failure]
        ranked = sorted(good, key=lambda number: self.trials[number].values)
        return list(takewhile(lambda number: number not in self.proven, ranked))[:most]

    def prove(self, number: int, runs: Sequence[Run | None]) -> None:
        """Take the longer runs of a trial. The first one continues the trial.

        One that is not stable in all of them, or whose error is larger at the end of the first, has failed.
        """
        trial = self.trials[number]
        failure = next(filter(None, (_failure(run, self.tuning.bounds) or _growth(run) for run in runs)), "")
        if not failure:
            last = None if runs[0] is None else self.objective.read(runs[0])
            failure = "" if last is not None and last <= _GROWN * trial.values[0] else _GROWS
        if failure:
            self.trials[number] = replace(trial, values=(self.objective.worst,), failure=failure)
        else:
            self.proven.add(number)


def find_gains(tunings: Sequence[StudyTuning], way: Way) -> Gains:
    """Return the gains that tunings find, by name; missing trials are executed.

    If every trial fails, a law keeps its previous values.

    Raises:
        RunnerError: if a key has no value for a factor, or as make_items does.
    """
    loader = Composer(way.config_dirs)
    searches = [search for tuning in tunings for search in _searches(tuning, loader)]
    for number in range(ROUNDS if searches else 0):
        print(f"{len(searches)} tunings, round {number + 1} of {ROUNDS} ...", file=sys.stderr)
        chosen = [(search, params) for search in searches for params in search.proposed(number)]
        made = _make([search.item(params, search.tuning.overrides) for search, params in chosen], way)
        for (search, params), run in zip(chosen, made, strict=True):
            search.take(params, run)
        _prove(searches, way)
    found: dict[str, list[Mapping[str, float]]] = {tuning.name: [] for tuning in tunings}
    for search in searches:
        found[search.tuning.name].append({} if search.best is None else search.trials[search.best].params)
    return found


def _prove(searches: Sequence[_Search], way: Way) -> None:
    """Make the longer runs of the trials that are best, until the best one of each search is stable.

    If one is not, twice as many follow, because a sweep of few runs takes nearly as long as one of many.
    """
    most = 1
    while left := [(search, place) for search in searches for place in search.unproven(most)]:
        print(f"longer runs of {len(left)} trials ...", file=sys.stderr)
        items = [
            search.item(search.trials[place].params, own) for search, place in left for own in search.tuning.longer
        ]
        made = iter(_make(items, way))
        for search, place in left:
            search.prove(place, list(islice(made, len(search.tuning.longer))))
        most *= 2


def _make(items: Sequence[Item], way: Way) -> list[Run | None]:
    """Execute runs as one sweep; return None for each missing one."""
    made = make_items({str(number): item for number, item in enumerate(items)}, way, trace="never")
    finished = store.Finished(way.outputs)
    return [None if one.missing else finished.open(one.place) for one in made.values()]


def _failure(run: Run | None, bounds: Mapping[str, float]) -> str:
    """Return why the run of a trial is none to take; empty for a good one."""
    if run is None or run.status != "ok":
        return "a repetition failed"
    for metric, bound in bounds.items():
        value = Objective(metric, "minimize").read(run)
        if value is None or value > bound:
            return f"{metric} is beyond its bound"
    return ""


def _growth(run: Run | None) -> str:
    """Return why a longer run is not stable: the last period's error is above that after 8 or 16. Empty where it is."""
    metrics = {} if run is None else run.metrics
    found = [metrics[name].median for after in _SETTLED if (name := f"{_ERROR}_period_{after}") in metrics]
    earlier = [each for each in found if each is not None]
    last = metrics[f"{_ERROR}_last_period"].median if earlier else 0.0
    return _GROWS if last is None or any(last > _GROWN * each for each in earlier) else ""


def _searches(tuning: StudyTuning, loader: Composer) -> list[_Search]:
    start = _start(tuning, loader)
    keys = [key_of(name, start[name], own) for name, own in tuning.ranges.items()]
    return [_Search(tuning, seed, keys, start) for seed in range(1, 1 + tuning.times)]


def _start(tuning: StudyTuning, loader: Composer) -> dict[str, float]:
    """Return the values of a tuning's keys in the config that its trials share."""
    if not tuning.ranges:
        return {}
    resolved = Grid(tuning.overrides, loader).composed(0).resolved
    return {key: read_number(tuning, key, resolved) for key in tuning.ranges}


def read_number(tuning: StudyTuning, key: str, resolved: Mapping[str, Any]) -> float:
    """Return the value that a key of a tuning has in a config.

    Raises:
        RunnerError: if it is not a number, or is 0.
    """
    value = get(resolved, key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not value:
        raise RunnerError(
            f"tuning {tuning.name}: {key} is {value!r}; a range of factors needs a number other than 0 to begin with"
        )
    return float(value)
