"""Tunings of a study as data, and tuned gains (`gains.yaml`): grids under `tunings` in `runs.yaml` of its folder.

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
one of these has the override `gains=macro/computed_torque/1`. A user-supplied controller has its ranges next to its
module, `mine/spring.ranges.yaml` next to `mine/spring.py`. Without these it keeps the values of its config.
"""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Self

import yaml
from pydantic import Field, PositiveInt, model_validator

from runner.base.atomic import write_atomically
from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.config.compose.files import refuse_settings
from runner.papers.study.code import UserPlugin
from runner.papers.study.grid import FlatOverrides, Level, Overrides, StudyGrid
from runner.papers.study.results import name_of
from runner.plugins.metric_units import unit_of, units
from runner.sweeps.tuning.key import TunedKey

Factor = Annotated[float, Field(gt=0.0)]
Range = Annotated[tuple[Factor, Factor], Field(strict=False)]
Ranges = Mapping[str, Range]
"""The lowest and the highest factor on the value that a key has otherwise, by key."""


@dataclass(frozen=True)
class StudyTuning:
    """Keys, ranges, objective and budget of a tuning.

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


class TunedGrid(StudyGrid):
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
        """Return the grid with user-supplied parts as further levels, with the ranges next to their modules."""
        made = super().with_parts(parts)
        axis = self._axis
        own = {part.name: _ranges_of(part) for part in parts if part.group == self.plugins.get(axis)}
        return made.model_copy(update={"ranges": {axis: {**self.ranges[axis], **own}}})

    def tunings(self, key: str, values: Mapping[str, float]) -> Iterator[StudyTuning]:
        """Yield what is tuned; see Grid.runs."""
        axis = self._axis
        for level, own in self.over[axis].items():
            ranges = self.ranges[axis].get(level, {})
            law = str(level), (f"{axis}={level}",) if own is None else own
            budget = self.trials if ranges else 1, self.times
            grid = self.only(axis, level)
            grids = [grid, *(grid.model_copy(update={"with_": each}) for each in self.longer)]
            for (parts, overrides), *longer in zip(*(each.runs(key, values) for each in grids), strict=True):
                runs = [own for _, own in longer]
                yield StudyTuning(name_of(parts), *law, overrides, ranges, self.minimize, self.bounds, *budget, runs)

    @property
    def _axis(self) -> str:
        return next(iter(self.ranges))

    def _levels(self, axis: str) -> list[str]:
        return [str(level) for level in self.over[axis]]


def all_tunings(grids: Mapping[str, TunedGrid], values: Mapping[str, float]) -> dict[str, StudyTuning]:
    """Return the tunings of several grids by name; see TunedGrid.tunings.

    Raises:
        RunnerError: if two have one name.
    """
    found: dict[str, StudyTuning] = {}
    for tuning in itertools.chain.from_iterable(grid.tunings(key, values) for key, grid in grids.items()):
        if tuning.name in found:
            raise RunnerError(f"tunings: the name '{tuning.name}' is that of another tuning")
        found[tuning.name] = tuning
    return found


def key_of(name: str, value: float, factors: Range) -> TunedKey:
    """Return the key of a range of factors on the value that it has otherwise."""
    low, high = (float(f"{value * factor:.6g}") for factor in factors)
    return TunedKey(name, low, high, step=None, log=True, integer=False)


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


FILE = "gains.yaml"
Gains = Mapping[str, Sequence[Mapping[str, float]]]
"""Of each tuning, by name, the values of its keys by each of its seeds."""

_KEY = "gains="


def read_gains(folder: Path) -> Gains:
    """Return the gains that are kept in the folder of a study; none where there is no such file.

    Raises:
        RunnerError: if the file cannot be read or does not fit.
    """
    path = folder / FILE
    gains = read_data(path, dict[str, list[dict[str, float]]]) if path.is_file() else {}
    refuse_settings((key for each in gains.values() for own in each for key in own), path)
    return gains


def write_gains(folder: Path, gains: Gains) -> None:
    """Write gains into a folder.

    Raises:
        OSError: if they cannot be written.
    """
    content = {name: [dict(own) for own in each] for name, each in gains.items()}
    text = yaml.safe_dump(content, sort_keys=False, width=200, default_flow_style=None)
    write_atomically(folder / FILE, f"# Made by the tunings of the study; see docs/paper.md.\n{text}".encode())


def put_in(overrides: Overrides, gains: Gains) -> Overrides:
    """Return a run's overrides with the gains of a tuning instead of the override that names it.

    One whose gains are not known yet stays unchanged.

    Raises:
        RunnerError: if a tuning has no such number.
    """
    return tuple(text for override in overrides for text in _put_in(override, gains))


def without_gains(overrides: Overrides) -> Overrides:
    """Return a run's overrides without those that name a tuning."""
    return tuple(text for text in overrides if not text.startswith(_KEY))


def named(overrides: Overrides) -> list[tuple[str, int]]:
    """Return the names of the tunings whose gains some overrides take, each with its number.

    Raises:
        RunnerError: if one ends in no number.
    """
    return [_named(text) for text in overrides if text.startswith(_KEY)]


def check_named(runs: Mapping[str, Overrides], times: Mapping[str, int]) -> None:
    """Check that all tunings that runs name are there.

    Args:
        runs: Overrides of each run.
        times: How many times each tuning is made, by its name.

    Raises:
        RunnerError: with the run and the name nearest to what it names.
    """
    for run, overrides in runs.items():
        for name, number in named(overrides):
            if name not in times:
                raise RunnerError(f"run '{run}': there is no tuning '{name}'{nearest(name, times)}")
            if not 1 <= number <= times[name]:
                raise RunnerError(f"run '{run}': tuning '{name}' is made {times[name]} times; found {number}")


def _put_in(override: str, gains: Gains) -> list[str]:
    if not override.startswith(_KEY):
        return [override]
    name, number = _named(override)
    if name not in gains:
        return [override]
    if number > len(gains[name]):
        raise RunnerError(f"{override}: {FILE} has the gains of {len(gains[name])} tunings; make them anew")
    return [f"{key}={value:.9g}" for key, value in gains[name][number - 1].items()]


def _named(override: str) -> tuple[str, int]:
    name, _, number = override.removeprefix(_KEY).rpartition("/")
    if not number.isdecimal() or int(number) < 1:
        raise RunnerError(f"{override}: must end in the number of a tuning, 1 or more")
    return name, int(number)
