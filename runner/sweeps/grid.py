"""Grid of a sweep: every combination of the values of some keys, the plan of `runner -m`."""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path

from runner.base.errors import ConfigError
from runner.config.compose.compose import Composed
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.options import groups
from runner.config.compose.overrides import force
from runner.schema.plausibility import LARGEST_WHOLE
from runner.store.axes import Counted, GridOverrides
from runner.sweeps.loading import ConfigSource, Loader
from runner.sweeps.plan import Alike, Block
from runner.sweeps.swept import SweptKey, is_simulated, parse_sweep
from runner.sweeps.template import Template

_SEED = "seed"


class Grid:
    """Every combination of the values of a sweep's keys; the last key changes fastest. See Plan.

    Args:
        arguments: Overrides, such as "robot=macro,mini" and "noise.position=1e-4,1e-3".
        source: Composes the configs.

    Raises:
        ConfigError: for what is no override, and for a key that is swept over no value.
    """

    def __init__(self, arguments: Sequence[str], source: ConfigSource) -> None:
        self._source = source
        self._keys = parse_sweep(force(arguments), groups(source.config_dirs), source.hydra)
        self._templates: dict[tuple[int, ...], Template | ConfigError] = {}

    def __len__(self) -> int:
        return math.prod(len(key.values) for key in self._keys)

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell; see Plan."""
        pairs = zip(self._keys, self._numbers(cell), strict=True)
        return tuple(key.text(number) for key, number in pairs if is_simulated(key.name))

    def axes(self) -> GridOverrides:
        """Return the overrides of all cells; see Plan."""
        swept = [key for key in self._keys if is_simulated(key.name) or len(key.overrides) > 1]
        return GridOverrides([_texts(key) for key in swept])

    def blocks(self) -> Iterator[Block]:
        """Yield the cells in blocks; see Plan."""
        place = self._place_of_seeds
        if place is None:
            yield from (Block(range(cell, cell + 1)) for cell in range(len(self)))
            return
        seeds, stride = self._keys[place].values, self._stride(place)
        for start in range(0, len(self), stride * len(seeds)):
            for first in range(start, start + stride):
                cells = range(first, first + stride * len(seeds), stride)
                if self._seeds_stand_alone(first, place):
                    yield Block(cells, seeds)
                else:
                    yield from (Block(range(cell, cell + 1)) for cell in cells)

    def alike(self, cells: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Composed]]]:
        """Yield those of some cells whose configs differ in nothing but the seed, with their configs; see Plan."""
        place = self._place_of_seeds
        if place is None:
            yield from (([cell], [self.composed(cell)]) for cell in cells)
            return
        key, stride = self._keys[place], self._stride(place)
        before = sum(is_simulated(each.name) for each in self._keys[:place])
        groups: dict[int, list[int]] = {}
        for cell in cells:
            groups.setdefault(cell - cell // stride % len(key.values) * stride, []).append(cell)
        for first, own in groups.items():
            if self._seeds_stand_alone(first, place):
                numbers = [cell // stride % len(key.values) for cell in own]
                texts = [key.overrides[number].removeprefix("++") for number in numbers]
                yield own, Alike(self.composed(own[0]), [key.values[number] for number in numbers], texts, before)
            else:
                yield from (([cell], [self.composed(cell)]) for cell in own)

    @cached_property
    def _place_of_seeds(self) -> int | None:
        """Place of the key that gives the seeds; None where no key gives nothing else."""
        return next((place for place, key in enumerate(self._keys) if key.name == _SEED and _may_be_seeds(key)), None)

    def _stride(self, place: int) -> int:
        """Return how many cells further the next value of a key stands."""
        return math.prod(len(key.values) for key in self._keys[place + 1 :])

    def _seeds_stand_alone(self, cell: int, place: int) -> bool:
        """Tell whether a key, given by its place, changes the seed and nothing else in cells that are as one."""
        numbers = self._numbers(cell)
        options = tuple(number for key, number in zip(self._keys, numbers, strict=True) if key.option)
        try:
            template = self._template(options)
        except ConfigError:
            return True  # the same problem in all of them
        return template.changes_alone(sum(not key.option for key in self._keys[:place]), (_SEED,))

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell; see Plan."""
        numbers = self._numbers(cell)
        pairs = list(zip(self._keys, numbers, strict=True))
        template = self._template(tuple(number for key, number in pairs if key.option))
        resolved = template.resolve([number for key, number in pairs if not key.option])
        return Composed(resolved, self.overrides(cell), template.choices, self._source.config_dirs)

    def _numbers(self, cell: int) -> list[int]:
        """Return the number of each key's value in a cell."""
        numbers = []
        for key in reversed(self._keys):
            cell, number = divmod(cell, len(key.values))
            numbers.append(number)
        return numbers[::-1]

    def _template(self, numbers: tuple[int, ...]) -> Template:
        if numbers not in self._templates:
            self._templates[numbers] = self._compose(numbers)
        template = self._templates[numbers]
        if isinstance(template, ConfigError):
            raise template
        return template

    def _compose(self, numbers: Sequence[int]) -> Template | ConfigError:
        options = [key for key in self._keys if key.option]
        texts = [key.overrides[number] for key, number in zip(options, numbers, strict=True)]
        try:
            config, own = self._source.load(texts), self._source.config_dirs
            return Template(config, config.hydra.runtime.choices, own, [key for key in self._keys if not key.option])
        except COMPOSITION_ERRORS as error:
            return explain(error, self._source.config_dirs)
        except ConfigError as error:
            return error


def _may_be_seeds(key: SweptKey) -> bool:
    """Tell whether all values of a key are seeds."""
    values = key.values
    if key.option:
        return False
    if isinstance(values, range):
        return min(values[0], values[-1]) >= 0 and max(values[0], values[-1]) <= LARGEST_WHOLE
    return all(type(value) is int and 0 <= value <= LARGEST_WHOLE for value in values)


def _texts(key: SweptKey) -> Sequence[str]:
    """Return the overrides of a key as typed; empty ones of a key that only says how runs are made."""
    if not is_simulated(key.name):
        return [""] * len(key.overrides)
    if isinstance(key.overrides, Counted):
        return Counted(key.overrides.start.removeprefix("++"), key.overrides.numbers)
    return [key.text(number) for number in range(len(key.values))]


def plan_sweep(overrides: Sequence[str], config_dirs: Sequence[Path] = ()) -> Grid:
    """Plan what `runner -m OVERRIDES` makes, from Python; see Grid."""
    return Grid(overrides, Loader(config_dirs))
