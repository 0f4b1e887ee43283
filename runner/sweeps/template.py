"""Composed config as a template for the values of many cells, with the same result as Hydra.

Hydra takes about 50 ms to compose a config. After it has composed one for a combination of group options, its own
function applies value overrides in about 5 ms; kept options and plain values need neither. Some keys only set certain
entries: their own, and those that interpolate it. For such a key the template sets these entries for a cell in about
3 us.
"""

import copy
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

from omegaconf import DictConfig, OmegaConf

from runner.base.dotted_keys import get
from runner.config.compose.compose import resolve
from runner.config.compose.composer import Composer, put_values
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.unresolved import Unresolved, read_kept
from runner.config.composed import Composed
from runner.sweeps.swept import SweptKey

Place = tuple[str, ...]  # path of a value in a config, such as ("noise", "position")
Changes = Mapping[Place, Any]

_GONE: Place = ()  # path of a key that another config lacks
_GROUPS_KEPT = 10_000


class Template:
    """Config composed for one combination of options, and the keys whose values are applied to it.

    Args:
        source: Composer of the configs.
        options: The overrides of options.
        root: Name of the root config in conf/: "config" for a run, "calibrate" for a calibration.
        keys: The value keys, in the order of the command line.

    Attributes:
        root: Name of the root config.
        choices: The option chosen in each group.

    Raises:
        ConfigError: if an option or a value cannot be composed.
    """

    def __init__(self, source: Composer, options: Sequence[str], root: str, keys: Sequence[SweptKey]) -> None:
        self.root, self._source, self._options, self._keys = root, source, options, keys
        first = self.compose([0] * len(keys))
        self._first, self.choices = first.resolved, first.choices
        self._changes = self._find_changes()
        self._keys_of: dict[str, list[int]] = {}  # numbers of the keys that change something in a group
        for index, changes in enumerate(self._changes or ()):
            for name in dict.fromkeys(place[0] for each in _distinct(changes) for place in each):
                self._keys_of.setdefault(name, []).append(index)
        self._groups: dict[tuple[object, ...], object] = {}

    def resolve(self, cell: Sequence[int]) -> Mapping[str, Any]:
        """Return the resolved config of a cell, given by the index of each key's value.

        Cells with an equal group share it as one object, which must not be changed.

        Raises:
            ConfigError: if the config cannot be composed.
        """
        if self._changes is None:
            return self.compose(cell).resolved
        resolved = dict(self._first)
        for name, keys in self._keys_of.items():
            numbers = [cell[key] for key in keys]
            if any(numbers):
                resolved[name] = self._group(name, numbers)
        return resolved

    def changes_alone(self, key: int, place: Place) -> bool:
        """Return True if the values of a key change only this entry, and no other key changes its group."""
        if self._changes is None:
            return False
        alone = all(not each or list(each) == [place] for each in _distinct(self._changes[key]))
        return alone and self._keys_of.get(place[0]) == [key]

    def _group(self, name: str, numbers: Sequence[int]) -> object:
        """Return a top-level entry of the config, given the index of the value of each key that changes it."""
        found = self._groups.get((name, *numbers))
        if found is None and self._changes is not None:
            made = {name: self._first.get(name)}
            for key, number in zip(self._keys_of[name], numbers, strict=True):
                for place, value in self._changes[key][number].items() if number else ():
                    if place[0] == name:
                        _put(made, place, value)
            found = made[name]
            if len(self._groups) >= _GROUPS_KEPT:
                self._groups.clear()
            self._groups[name, *numbers] = found
        return found

    def compose(self, cell: Sequence[int]) -> Composed:
        """Compose a cell from kept options, or with Hydra's own function for value overrides; see `resolve`."""
        texts = [key.override(number) for key, number in zip(self._keys, cell, strict=True)]
        folders = self._source.config_dirs
        unresolved = read_kept([*self._options, *texts], folders, self.root)
        return resolve(unresolved or self._from_hydra(texts), texts, folders)

    def _from_hydra(self, texts: Sequence[str]) -> Unresolved:
        config = copy.deepcopy(self._config)
        try:
            put_values(config, texts)
        except COMPOSITION_ERRORS as error:
            raise explain(error, self._source.config_dirs) from None
        values: Any = OmegaConf.to_container(config, resolve=False)
        return Unresolved(values, self._composed.hydra.runtime.choices, {})

    @cached_property
    def _composed(self) -> DictConfig:
        """The config that Hydra composes from only the options."""
        return self._source.load(self._options, self.root)

    @cached_property
    def _config(self) -> DictConfig:
        """The same without Hydra's own node."""
        config: DictConfig = OmegaConf.masked_copy(
            self._composed, [str(key) for key in self._composed if key != "hydra"]
        )
        OmegaConf.set_struct(config, True)
        return config

    def _find_changes(self) -> "list[Sequence[Changes]] | None":
        """Return the changes of each value of each key from the first cell, or None if keys may interact.

        Keys interact if two of them change one entry. They may interact if values are interpolations, or mappings,
        which Hydra merges.
        """
        swept = [key.values for key in self._keys if len(key.values) > 1]
        if not all(isinstance(values, range) or all(map(_is_plain, values)) for values in swept):
            return None
        found: list[Sequence[Changes]] = []
        places: set[Place] = set()
        for index, key in enumerate(self._keys):
            changes = self._changes_of(index, key)
            own = {place for change in _distinct(changes) for place in change}
            if _GONE in own or any(_overlap(one, other) for one in own for other in places):
                return None
            places |= own
            found.append(changes)
        return found

    def _changes_of(self, index: int, key: SweptKey) -> Sequence[Changes]:
        def change(number: int) -> Changes:
            cell = [0] * len(self._keys)
            cell[index] = number
            return dict(_difference(self._first, self.compose(cell).resolved))

        first = key.values[0]
        other = next((number for number, value in enumerate(key.values) if repr(value) != repr(first)), None)
        if other is None:
            return [{}] * len(key.values)
        types = {int} if isinstance(key.values, range) else _types_in(key.values)
        if types >= {int, float}:  # a float key has floats in any case
            return [change(number) for number in range(len(key.values))]
        places = change(other)
        pairs = [(get(self._first, place), value) for place, value in places.items()]
        if all(repr(pair) == repr((first, key.values[other])) for pair in pairs):
            return _Same(list(places), key.values)
        if types == {int} and all(repr(pair) == repr((float(first), float(key.values[other]))) for pair in pairs):
            return _Same(list(places), key.values, as_floats=True)
        return [change(number) for number in range(len(key.values))]


class _Same(Sequence[Changes]):
    """Changes of a key that sets the same entries for each value; created on demand because it may have a million."""

    def __init__(self, places: Sequence[Place], values: Sequence[Any], as_floats: bool = False) -> None:
        self._places, self._values, self._as_floats = places, values, as_floats

    def __len__(self) -> int:
        return len(self._values)

    def __getitem__(self, number: Any) -> Any:
        value = self._values[number]
        return dict.fromkeys(self._places, float(value) if self._as_floats else value)


def _distinct(changes: Sequence[Changes]) -> Sequence[Changes]:
    """Return changes, without those that are known to affect the same entries as others."""
    return [changes[0]] if isinstance(changes, _Same) else changes


def _types_in(values: Sequence[Any]) -> set[type]:
    """Return the types of values, and of those in nested lists."""
    types = set(map(type, values))
    return types.union(*(_types_in(value) for value in values if type(value) is list)) if list in types else types


def _is_plain(value: Any) -> bool:
    if isinstance(value, list):
        return all(_is_plain(part) for part in value)
    if isinstance(value, str):
        return "$" not in value and "\\" not in value
    return value is None or isinstance(value, bool | int | float)


def _difference(first: Any, other: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Yield the path of each difference between two configs and the other's value; _GONE for a key that it lacks."""
    if not (isinstance(first, Mapping) and isinstance(other, Mapping)):
        if repr(first) != repr(other):  # 1, 1.0 and True are three values
            yield place, other
        return
    for key in {**first, **other}:
        if key not in other:
            yield _GONE, None
        elif key not in first:
            yield (*place, key), other[key]
        else:
            yield from _difference(first[key], other[key], (*place, key))


def _put(config: dict[str, Any], place: Place, value: Any) -> None:
    """Set a value in a config whose root is a copy; the mappings on the path are copied first."""
    for key in place[:-1]:
        inner = dict(config[key])
        config[key] = inner
        config = inner
    config[place[-1]] = value


def _overlap(one: Place, other: Place) -> bool:
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]
