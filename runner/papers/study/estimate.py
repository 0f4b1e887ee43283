"""Estimated computing time of tunings and of the runs of the tuned controllers."""

import os
import shlex
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.config.compose.composer import Composer
from runner.papers.study.grid import Overrides
from runner.papers.study.items import Way, listed
from runner.papers.study.study import Study
from runner.papers.study.tune import ROUNDS
from runner.papers.study.tunings import StudyTuning, named, without_gains
from runner.sweeps.check import check
from runner.sweeps.estimate import START_UP, Estimate, estimate
from runner.sweeps.plan import Item, Listed, Plan

Counts = tuple[int, int, int]
"""Numbers of trials, of long runs, and of the runs that follow."""

_CHOSEN = 0.05  # s in which the command chooses, composes and checks a trial


@dataclass(frozen=True)
class Amount:
    """Number and cost of the pending runs with one robot, or with all.

    Attributes:
        trials: Number of trials of all tunings.
        longer: Number of long runs of trials, about: a trial in each round of a tuning.
        runs: Number of the runs that follow.
        time: The CPU time of all.
    """

    trials: int
    longer: int
    runs: int
    time: Estimate

    def __add__(self, other: "Amount") -> "Amount":
        known = other.time.known if self.time.known == "about" else self.time.known
        time = Estimate(self.time.seconds + other.time.seconds, known)
        return Amount(self.trials + other.trials, self.longer + other.longer, self.runs + other.runs, time)

    def in_words(self, workers: int) -> str:
        """Return number and time of all, made by this many processes; 0 stands for the command itself."""
        processes = max(workers, 1)
        together = min(processes, os.cpu_count() or 1)
        sweeps = 1 + ROUNDS * ((self.trials > 0) + (self.longer > 0))
        start = sweeps * START_UP * workers / together
        time = self.time.in_words(processes, together, start + _CHOSEN * self.trials)
        longer = f", some {self.longer:,} long runs" if self.longer else ""
        tuned = f"{self.trials:,} trials in {ROUNDS} rounds{longer}, then " if self.trials else ""
        return f"{tuned}{self.runs:,} runs: {time} for all"


def counted(study: Study, tunings: Sequence[StudyTuning], chosen: Collection[str]) -> dict[Overrides, Counts]:
    """Return the numbers of trials, long runs and following runs, by their overrides.

    The gains are omitted because they are not known yet. Stored runs count like missing ones.

    Args:
        study: The study.
        tunings: The tunings.
        chosen: Overrides by which laws are chosen; the runs are those that have one of them.
    """
    trials: Counter[Overrides] = Counter()
    longer: Counter[Overrides] = Counter()
    for each in tunings:
        trials[each.overrides] += each.trials * each.times
        for own in each.longer:
            longer[own] += ROUNDS * each.times
    runs = Counter(map(without_gains, _runs(study, tunings, chosen)))
    return {own: (trials[own], longer[own], runs[own]) for own in dict.fromkeys([*trials, *longer, *runs])}


def planned(cells: Iterable[Overrides], way: Way) -> Listed:
    """Return runs as a plan, those with the same overrides once."""
    items = {shlex.join(own): Item(own) for own in cells}
    return listed(items, way, Composer(way.config_dirs), "never")


def estimate_all(plan: Plan, counts: Sequence[Counts]) -> dict[str, Amount]:
    """Return the cost of the cells of a plan, by robot; the counts are the numbers of runs of each cell.

    Raises:
        ConfigError: if one of them cannot be made.
    """
    checked, table = check(plan), np.array(counts)
    robots = [plan.composed(cell).choices["robot"] for cell in range(len(plan))]
    found = {}
    for robot in dict.fromkeys(robots):
        own = table * (np.array(robots) == robot)[:, None]
        time = estimate(plan, checked, np.repeat(np.arange(len(plan)), own.sum(axis=1)), kept=0.0)
        trials, longer, runs = own.sum(axis=0).tolist()
        found[robot] = Amount(trials, longer, runs, time)
    return found


def _runs(study: Study, tunings: Sequence[StudyTuning], chosen: Collection[str]) -> Iterable[Overrides]:
    """Return the runs of some laws; where no key is tuned, all gains of a law are the same."""
    same = {each.name for each in tunings if not each.ranges}
    runs = (own for own in study.jobs().values() if not set(chosen).isdisjoint(own))
    return dict.fromkeys(without_gains(own) if any(name in same for name, _ in named(own)) else own for own in runs)


def cost_line(laws: Sequence[str], amounts: Mapping[str, Amount], workers: int) -> str:
    """Return a line with the law or the number of laws, the number of arms, and the cost."""
    total = sum(amounts.values(), start=Amount(0, 0, 0, Estimate(0.0)))
    named_laws = laws[0] if len(laws) == 1 else f"{len(laws)} laws"
    return f"{named_laws} on {len(amounts)} arm{'s' if len(amounts) > 1 else ''}: {total.in_words(workers)}"
