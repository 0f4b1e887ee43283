"""The tunings of a work: their trials are runs as others are, and what they find are the gains of its runs."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from runner import store
from runner.errors import RunnerError
from runner.sweeps.grid import Grid
from runner.sweeps.listed import Item
from runner.sweeps.loading import Loader
from runner.works.gains import Gains
from runner.works.items import Way, make_items
from runner.works.search import ROUNDS, Tried, best, judged, proposed
from runner.works.tunings import Tuning


@dataclass
class _Search:
    """One of the tunings of a law: the values that its keys have otherwise, and the trials that ended."""

    tuning: Tuning
    seed: int
    defaults: Mapping[str, float]
    tried: list[Tried] = field(default_factory=list)

    def gains(self, factors: Mapping[str, float]) -> dict[str, float]:
        """Return the values of the keys for factors on them; those that are as they are otherwise left out."""
        return {key: float(f"{self.defaults[key] * own:.6g}") for key, own in factors.items() if own != 1.0}

    def item(self, factors: Mapping[str, float]) -> Item:
        """Return the run of a trial. Its seed is none of those of the runs that are judged."""
        chosen = (f"{key}={value!r}" for key, value in self.gains(factors).items())
        return Item((*self.tuning.overrides, f"seed={self.seed}", *chosen))


def find_gains(tunings: Sequence[Tuning], way: Way) -> Gains:
    """Return what tunings find, by name; their trials are made where they are not stored yet.

    Raises:
        RunnerError: if a key has no value for a factor, or as make_items does.
    """
    loader = Loader(way.config_dirs)
    defaults = {tuning.name: _defaults(tuning, loader) for tuning in tunings}
    searches = [_Search(each, 1 + index, defaults[each.name]) for each in tunings for index in range(each.times)]
    for number in range(ROUNDS if searches else 0):
        print(f"{len(searches)} tunings of {len(tunings)} laws, round {number + 1} of {ROUNDS} ...", file=sys.stderr)
        _round(searches, way)
    return {
        tuning.name: [each.gains(best(each.tried).factors) for each in searches if each.tuning.name == tuning.name]
        for tuning in tunings
    }


def _round(searches: Sequence[_Search], way: Way) -> None:
    """Make the trials of a round of all searches as one sweep."""
    chosen = [(search, proposed(search.tuning, search.seed, search.tried)) for search in searches]
    trials = [(search, factors) for search, each in chosen for factors in each]
    items = {str(number): search.item(factors) for number, (search, factors) in enumerate(trials)}
    made = make_items(items, way, trace="never")
    finished = store.Finished(way.outputs)
    for (search, factors), one in zip(trials, made.values(), strict=True):
        run = None if one.missing else finished.open(one.place)
        search.tried.append(judged(search.tuning, factors, run))


def _defaults(tuning: Tuning, loader: Loader) -> dict[str, float]:
    """Return the values of a tuning's keys in the config that its trials share."""
    if not tuning.ranges:
        return {}
    resolved = Grid(tuning.overrides, loader).composed(0).resolved
    return {key: _number(tuning, key, resolved) for key in tuning.ranges}


def _number(tuning: Tuning, key: str, resolved: Mapping[str, Any]) -> float:
    value: Any = resolved
    for part in key.split("."):
        value = value.get(part) if isinstance(value, Mapping) else None
    if isinstance(value, bool) or not isinstance(value, int | float) or not value:
        raise RunnerError(
            f"tuning {tuning.name}: {key} is {value!r}; a range of factors needs a number other than 0 to begin with"
        )
    return float(value)
