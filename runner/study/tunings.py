"""Tunings of a study as data: grids under `tunings` in `runs.yaml` of its folder.

    tunings:
      macro:
        with: [robot=macro, trajectory=lissajous, repetitions=8]
        over: {law: &laws [computed_torque, passivity]}
        ranges:
          law:
            computed_torque: {controller.natural_frequency: [0.5, 2], controller.damping_ratio: [0.6, 1.5]}
            passivity: {controller.natural_frequency: [0.5, 2]}
        minimize: rms_tracking_error
        bounds: {torque_chatter: 50}

Each combination of levels is tuned. Its name is the name that its run would have: `macro/computed_torque`. A range
contains factors on the value that the key otherwise has, searched on a logarithmic scale. All tunings have the same
budget: the value that the keys otherwise have, and others up to `trials` in all.

`longer` lists the overrides of further runs, in the format of `with`. A trial that would become the best one must be
stable in them. It is rejected if a repetition fails, a metric exceeds its bound, or the error grows from period to
period.

Each tuning is done three times, or `times` times, with different seeds of search and runs. A run with the gains of
one of these has the override `gains=macro/computed_torque/1`; runner/study/gains.py describes the file. A
user-supplied controller has its ranges next to its module, `mine/spring.ranges.yaml` next to `mine/spring.py`.
Without these it keeps the values of its config.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import Field, PositiveInt, model_validator

from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.plugins.metric_units import unit_of, units
from runner.study.arithmetic import Level
from runner.study.grid import FlatOverrides, Grid, Overrides
from runner.study.plugins import UserPlugin
from runner.sweeps.tuning.key import Key

Factor = Annotated[float, Field(gt=0.0)]
Range = Annotated[tuple[Factor, Factor], Field(strict=False)]
Ranges = Mapping[str, Range]
"""The lowest and the highest factor on the value that a key has otherwise, by key."""


@dataclass(frozen=True)
class Tuning:
    """What is tuned, towards what, with which budget.

    Attributes:
        name: Its name.
        law: The level that the ranges belong to.
        chosen: The overrides that this level stands for.
        overrides: The overrides that all its trials have.
        ranges: The ranges of its keys; none where nothing is tuned.
        minimize: The metric that is to be small.
        bounds: What other metrics are to stay below.
        trials: Number of trials; 1 where nothing is tuned.
        times: How many times it is tuned, each by another seed.
        longer: The overrides of each longer run in which the best trial must be stable.
    """

    name: str
    law: str
    chosen: Overrides
    overrides: Overrides
    ranges: Ranges
    minimize: str
    bounds: Mapping[str, float]
    trials: int
    times: int
    longer: Sequence[Overrides]


class TunedGrid(Grid):
    """A grid whose combinations are tuned.

    Attributes:
        ranges: Ranges by level, of one axis.
        minimize: The metric that is to be small: its median over the repetitions.
        bounds: What the medians of other metrics are to stay below.
        trials: Number of trials.
        times: How many times each combination is tuned, each by another seed.
        longer: Overrides, as in `with`, of each longer run in which the best trial must be stable.
    """

    ranges: Annotated[dict[str, dict[Level, dict[str, Range]]], Field(min_length=1, max_length=1)]
    minimize: str
    bounds: dict[str, Factor] = Field(default_factory=dict)
    trials: PositiveInt = 32
    times: PositiveInt = 3
    longer: list[FlatOverrides] = Field(default_factory=list)

    @model_validator(mode="after")
    def _what_is_there(self) -> "TunedGrid":
        for axis, levels in self.ranges.items():
            if axis not in self.over:
                raise ValueError(f"ranges: there is no axis '{axis}'{nearest(axis, self.over)}")
            for level, ranges in levels.items():
                if level not in self.over[axis]:
                    raise ValueError(f"ranges.{axis}: no level '{level}'{nearest(str(level), self._levels(axis))}")
                _check_ranges(ranges)
        for metric in (self.minimize, *self.bounds):
            if unit_of(metric) is None:
                raise ValueError(f"there is no metric '{metric}'{nearest(metric, units())}")
        return self

    def with_parts(self, parts: Sequence[UserPlugin]) -> Self:
        """Return the grid with parts of the user's as further levels, with the ranges that stand beside them."""
        made = super().with_parts(parts)
        axis = self._axis
        own = {part.name: _ranges_of(part) for part in parts if part.group == self.plugins.get(axis)}
        return made.model_copy(update={"ranges": {axis: {**self.ranges[axis], **own}}})

    def tunings(self, key: str, values: Mapping[str, float]) -> Iterator[Tuning]:
        """Yield what is tuned; see Grid.runs."""
        axis = self._axis
        for level, own in self.over[axis].items():
            ranges = self.ranges[axis].get(level, {})
            law = str(level), (f"{axis}={level}",) if own is None else own
            budget = self.trials if ranges else 1, self.times
            grid = self.only(axis, level)
            grids = [grid, *(grid.model_copy(update={"with_": each}) for each in self.longer)]
            for (name, overrides), *longer in zip(*(each.runs(key, values) for each in grids), strict=True):
                runs = [own for _, own in longer]
                yield Tuning(name, *law, overrides, ranges, self.minimize, self.bounds, *budget, runs)

    @property
    def _axis(self) -> str:
        return next(iter(self.ranges))

    def _levels(self, axis: str) -> list[str]:
        return [str(level) for level in self.over[axis]]


def all_tunings(grids: Mapping[str, TunedGrid], values: Mapping[str, float]) -> dict[str, Tuning]:
    """Return the tunings of several grids by name; see TunedGrid.tunings.

    Raises:
        RunnerError: if two have one name.
    """
    found: dict[str, Tuning] = {}
    for tuning in itertools.chain.from_iterable(grid.tunings(key, values) for key, grid in grids.items()):
        if tuning.name in found:
            raise RunnerError(f"tunings: the name '{tuning.name}' is that of another tuning")
        found[tuning.name] = tuning
    return found


def key_of(name: str, value: float, factors: Range) -> Key:
    """Return the key of a range of factors on the value that it has otherwise."""
    low, high = (float(f"{value * factor:.6g}") for factor in factors)
    return Key(name, low, high, step=None, log=True, integer=False)


def _ranges_of(part: UserPlugin) -> Ranges:
    path = part.folder / f"{part.name}.ranges.yaml"
    if not path.is_file():
        return {}
    ranges = read_data(path, dict[str, Range])
    try:
        _check_ranges(ranges)
    except ValueError as error:
        raise RunnerError(f"{path}: {error}") from None
    return ranges


def _check_ranges(ranges: Ranges) -> None:
    for key, (low, high) in ranges.items():
        if not low <= 1.0 <= high or low == high:
            raise ValueError(
                f"{key}: its range must be factors below and above 1, as [0.5, 2]; found {low:g}, {high:g}"
            )
