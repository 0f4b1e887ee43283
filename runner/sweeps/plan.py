"""Plan of a sweep: cells that are composed on demand, as a grid for `runner -m` and as a list for a study."""

import copy
import math
from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from runner.base.errors import ConfigError
from runner.config.compose.composer import Composer
from runner.config.compose.files import groups
from runner.config.compose.overrides import prepare
from runner.config.composed import Composed
from runner.schema.model import LARGEST_WHOLE
from runner.store.axes import Axes, SweepAxis, digits, is_simulated
from runner.sweeps.swept import SweptKey, merge, parse_sweep, read_keys
from runner.sweeps.template import Template

_SEED = "seed"


@dataclass(frozen=True)
class SeedBlock:
    """Cells whose configs differ only in the seed.

    Attributes:
        cells: The cells.
        seeds: Seed of each cell; None for a single cell.
    """

    cells: range
    seeds: Sequence[int] | None = None


@dataclass(frozen=True)
class Alike(Sequence[Composed]):
    """Configs that differ only in the seed. They are created on demand; only one of them is sent to another process.

    Attributes:
        first: One of the configs.
        seeds: Seed of each config.
        texts: Override of the seed of each config.
        place: Index of that override in the overrides of a config.
    """

    first: Composed
    seeds: Sequence[int]
    texts: Sequence[str]
    place: int

    def __len__(self) -> int:
        return len(self.seeds)

    def __getitem__(self, number: Any) -> Any:
        first, place = self.first, self.place
        overrides = (*first.overrides[:place], self.texts[number], *first.overrides[place + 1 :])
        resolved = {**first.resolved, "seed": self.seeds[number]}
        return Composed(resolved, overrides, first.choices, first.config_dirs, first.root)


class Plan(ABC):
    """Runs and calibrations of a sweep, its cells. Cells with the same options are composed together.

    Args:
        source: Composer of the configs.
    """

    def __init__(self, source: Composer) -> None:
        self._source = source
        self._templates: dict[Hashable, Template | ConfigError] = {}

    @property
    def whole(self) -> "Plan":
        """The plan of the whole sweep; the plan itself if it is not a part."""
        return self

    @abstractmethod
    def __len__(self) -> int:
        """Return the number of cells."""

    @abstractmethod
    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell as typed, except those that do not affect the simulation."""

    @abstractmethod
    def _locate(self, cell: int) -> tuple[Hashable, Sequence[int]]:
        """Return the key of the template of a cell, and the index of the value of each of its keys."""

    @abstractmethod
    def _parts(self, group: Hashable) -> tuple[Sequence[str], Sequence[SweptKey], str]:
        """Return the parts of a template: the overrides of options, the keys of values and the root."""

    def axes(self) -> Axes | None:
        """Return the axes of a grid, whose cells have every combination of values; None if the plan is not a grid."""
        return None

    def blocks(self) -> Iterator[SeedBlock]:
        """Yield all cells, in blocks that differ only in the seed."""
        return (SeedBlock(range(cell, cell + 1)) for cell in range(len(self)))

    def alike(self, cells: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Composed]]]:
        """Yield groups of the given cells whose configs differ only in the seed, with their configs."""
        return (([cell], [self.composed(cell)]) for cell in cells)

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell. Cells with an equal group share it as one object.

        Raises:
            ConfigError: if the config cannot be composed.
        """
        group, numbers = self._locate(cell)
        template = self._template(group)
        resolved = template.resolve(numbers)
        return Composed(resolved, self.overrides(cell), template.choices, self._source.config_dirs, template.root)

    def _template(self, group: Hashable) -> Template:
        if group not in self._templates:
            self._templates[group] = self._compose(*self._parts(group))
        template = self._templates[group]
        if isinstance(template, ConfigError):
            raise template
        return template

    def _compose(self, options: Sequence[str], keys: Sequence[SweptKey], root: str) -> Template | ConfigError:
        try:
            return Template(self._source, options, root, keys)
        except ConfigError as error:
            return error


class Grid(Plan):
    """Every combination of the values of a sweep's keys; the last key changes fastest.

    Args:
        arguments: Overrides, such as "robot=macro,mini" and "noise.position=1e-4,1e-3", and axes with typed values.
        source: Composer of the configs.

    Raises:
        ConfigError: if an override is not valid, or a key is swept over no value.
    """

    def __init__(self, arguments: Sequence[str | SweepAxis], source: Composer) -> None:
        super().__init__(source)
        self._keys = parse_sweep(arguments, groups(source.config_dirs), source.hydra)
        self._sizes = [len(key.values) for key in self._keys]
        self._axes = Axes([key.entry() for key in self._keys if len(key.values) > 1 or is_simulated(key.name)])

    def __len__(self) -> int:
        return math.prod(self._sizes)

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell; see Plan."""
        found: tuple[str, ...] = self._axes[cell]
        return found

    def axes(self) -> Axes:
        """Return the axes; see Plan."""
        return self._axes

    def blocks(self) -> Iterator[SeedBlock]:
        """Yield the cells in blocks; see Plan."""
        place = self._place_of_seeds
        if place is None:
            yield from super().blocks()
            return
        seeds, stride = self._keys[place].values, math.prod(self._sizes[place + 1 :])
        for start in range(0, len(self), stride * len(seeds)):
            for first in range(start, start + stride):
                cells = range(first, first + stride * len(seeds), stride)
                if self._seeds_stand_alone(first, place):
                    yield SeedBlock(cells, seeds)
                else:
                    yield from (SeedBlock(range(cell, cell + 1)) for cell in cells)

    def alike(self, cells: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Composed]]]:
        """Yield groups of the given cells whose configs differ only in the seed, with their configs; see Plan."""
        place = self._place_of_seeds
        if place is None:
            yield from super().alike(cells)
            return
        key, stride = self._keys[place], math.prod(self._sizes[place + 1 :])
        before = sum(is_simulated(each.name) for each in self._keys[:place])
        together: dict[int, list[int]] = {}
        for cell in cells:
            together.setdefault(cell - cell // stride % len(key.values) * stride, []).append(cell)
        for first, own in together.items():
            if self._seeds_stand_alone(first, place):
                numbers = [cell // stride % len(key.values) for cell in own]
                texts = [key.override(number) for number in numbers]
                yield own, Alike(self.composed(own[0]), [key.values[number] for number in numbers], texts, before)
            else:
                yield from super().alike(own)

    @cached_property
    def _place_of_seeds(self) -> int | None:
        """Index of the key whose values are all seeds; None if there is none."""
        return next((place for place, key in enumerate(self._keys) if key.name == _SEED and _may_be_seeds(key)), None)

    def _seeds_stand_alone(self, cell: int, place: int) -> bool:
        """Return True if the key at an index changes only the seed in the cells that share the options of a cell."""
        try:
            template = self._template(self._locate(cell)[0])
        except ConfigError:
            return True  # all of these cells have the same problem
        pairs = zip(self._keys[:place], digits(cell, self._sizes), strict=False)
        return template.changes_alone(sum(not key.chooses(number) for key, number in pairs), (_SEED,))

    def _locate(self, cell: int) -> tuple[tuple[int, ...], list[int]]:
        pairs = list(zip(self._keys, digits(cell, self._sizes), strict=True))
        group = tuple(number for key, number in pairs if key.option)
        return group, [0 if key.option else number for key, number in pairs if not (key.option and key.chooses(number))]

    def _parts(self, group: Any) -> tuple[Sequence[str], Sequence[SweptKey], str]:
        numbers = iter(group)
        keys = [key.only(next(numbers)) if key.option else key for key in self._keys]
        return [key.override(0) for key in keys if key.option], [key for key in keys if not key.option], "config"


@dataclass(frozen=True)
class Item:
    """Run or calibration of a list.

    Attributes:
        overrides: Overrides of the run or calibration.
        root: Name of the root config in conf/: "config" for a run, "calibrate" for a calibration.
    """

    overrides: tuple[str, ...]
    root: str = "config"


class Listed(Plan):
    """Runs and calibrations by name.

    Args:
        items: The runs and calibrations, by name.
        shared: Overrides of all runs, such as "outputs=FOLDER" and "sweep.trace=all". For a calibration, only outputs
            has an effect.
        loader: Composer of the configs.

    Raises:
        ConfigError: if an override is not valid.
    """

    def __init__(self, items: Mapping[str, Item], shared: Sequence[str], loader: Composer) -> None:
        super().__init__(loader)
        self._items = tuple(items.values())
        texts = list(dict.fromkeys(text for item in self._items for text in (*item.overrides, *shared)))
        read = dict(zip(texts, read_keys(prepare(texts), groups(loader.config_dirs), loader.hydra), strict=True))
        if several := [text for text, key in read.items() if len(key.values) > 1]:
            raise ConfigError(
                [f"{text}: has several values; a run of a list has one value for each key" for text in several]
            )
        self._cells: dict[Hashable, list[list[SweptKey]]] = {}  # value keys of each cell, by template
        self._places: list[tuple[Hashable, int]] = []
        for item in self._items:
            taken = [text for text in shared if item.root == "config" or text.startswith("outputs=")]
            keys = merge([read[text] for text in (*item.overrides, *taken)])
            options, values = [[key for key in keys if key.option is which] for which in (True, False)]
            group = item.root, tuple(key.override(0) for key in options), tuple(key.start for key in values)
            together = self._cells.setdefault(group, [])
            self._places.append((group, len(together)))
            together.append(values)

    def __len__(self) -> int:
        return len(self._items)

    def only(self, cells: Sequence[int]) -> "Listed":
        """Return the plan of some of the cells, which shares what is composed."""
        chosen = copy.copy(self)
        chosen._items = tuple(self._items[cell] for cell in cells)
        chosen._places = [self._places[cell] for cell in cells]
        return chosen

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell; see Plan."""
        return self._items[cell].overrides

    def _locate(self, cell: int) -> tuple[Hashable, Sequence[int]]:
        group, place = self._places[cell]
        return group, [place] * len(self._cells[group][0])

    def _parts(self, group: Any) -> tuple[Sequence[str], Sequence[SweptKey], str]:
        root, options, starts = group
        columns = zip(starts, zip(*self._cells[group], strict=True), strict=True)
        keys = [
            SweptKey(same[0].name, [key.values[0] for key in same], option=False, start=start)
            for start, same in (columns if starts else ())
        ]
        return options, keys, root


def _may_be_seeds(key: SweptKey) -> bool:
    values = key.values
    if key.option:
        return False
    if isinstance(values, range):
        return min(values[0], values[-1]) >= 0 and max(values[0], values[-1]) <= LARGEST_WHOLE
    return all(type(value) is int and 0 <= value <= LARGEST_WHOLE for value in values)
