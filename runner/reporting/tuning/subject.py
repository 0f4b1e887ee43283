"""Subject of a tuning report: trials in order, successful trials and best trials."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number, quantity
from runner.reporting.metric_titles import metric_label, title
from runner.sweeps.tuning.key import Key
from runner.sweeps.tuning.objective import Objective, Trial, best
from runner.sweeps.tuning.study import Tuning


@dataclass(frozen=True)
class Subject:
    """A tuning as its report looks at it.

    Attributes:
        tuning: The tuning.
    """

    tuning: Tuning

    @property
    def keys(self) -> Sequence[Key]:
        """The tuned keys."""
        return self.tuning.study.keys

    @property
    def objectives(self) -> Sequence[Objective]:
        """What was to get better."""
        return self.tuning.study.objectives

    @property
    def trials(self) -> Sequence[Trial]:
        """All trials, in order."""
        return self.tuning.trials

    @cached_property
    def good(self) -> list[int]:
        """Numbers of the trials that did not fail."""
        return [place for place, trial in enumerate(self.trials) if not trial.failure]

    @cached_property
    def best(self) -> list[int]:
        """Numbers of the best trials: one, or the Pareto front."""
        return best(self.trials, self.objectives)

    @cached_property
    def values(self) -> FloatArray:
        """Value of each objective in the good trials, shape (good, objectives)."""
        return np.array([self.trials[place].values for place in self.good]).reshape(len(self.good), -1)

    def hints(self, numbers: Sequence[int]) -> list[str]:
        """Return what a reader is told of some trials when pointing at them."""
        return [f"trial {place}: {self.settings(place)}; {self.outcome(place)}" for place in numbers]

    def runs(self, numbers: Sequence[int]) -> list[str]:
        """Return the hashes of some trials' runs."""
        return [self.trials[place].run for place in numbers]

    def settings(self, place: int) -> str:
        """Return the values of the keys in a trial."""
        params = self.trials[place].params
        return ", ".join(f"{key.name}={params[key.name]:.5g}" for key in self.keys)

    def outcome(self, place: int) -> str:
        """Return the values of the objectives in a good trial."""
        values = zip(self.objectives, self.trials[place].values, strict=True)
        return ", ".join(f"{title(objective.metric)} {quantity(value, objective.unit)}" for objective, value in values)

    def best_by_objective(self) -> dict[int, list[Objective]]:
        """Return the trials on the front that are best in an objective, with the objectives that each is best in."""
        found: dict[int, list[Objective]] = {}
        for index, objective in enumerate(self.objectives):
            losses = {place: objective.sign * self.trials[place].values[index] for place in self.best}
            found.setdefault(min(losses, key=losses.__getitem__), []).append(objective)
        return found


def label(objective: Objective) -> str:
    """Return the title of an objective's metric with its unit, as on the axis of a figure."""
    return metric_label(objective.metric, objective.unit)


def key_value(value: float) -> str:
    """Return the value of a key as text."""
    return number(value, 4)
