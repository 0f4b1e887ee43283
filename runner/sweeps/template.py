"""Composed config as a template for the values of many cells, with the same result as Hydra.

Hydra takes about 50 ms to compose a config. After it has composed one for a combination of group options, its own
function applies value overrides in about 5 ms. Some keys only put their value in certain places: their own,
and those that interpolate it. For such a key the template puts the value of a cell there in about 3 us.
"""

import copy
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from omegaconf import DictConfig, OmegaConf

from runner.base.dotted_keys import get
from runner.config.compose.compose import Composed, from_hydra
from runner.config.compose.composer import put_values
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.sweeps.swept import SweptKey

Place = tuple[str, ...]  # of a value in a config, such as ("noise", "position")
Changes = Mapping[Place, Any]

_GONE: Place = ()  # stands for a key that another config lacks
_GROUPS_KEPT = 10_000


class Template:
    """A config composed for one combination of options, and the keys whose values are applied to it.

    Args:
        config: The config as Hydra composed it from the options alone.
        root: Name of the file in conf/ that it hangs on: "config" of a run, "calibrate" of a calibration.
        config_dirs: Config folders of the user's.
        keys: The keys of values, in the order of the command line.

    Attributes:
        root: As given.
        choices: The option chosen in each of our groups.

    Raises:
        ConfigError: if a value does not compose.
    """

    def __init__(self, config: DictConfig, root: str, config_dirs: Sequence[Path], keys: Sequence[SweptKey]) -> None:
        self.root, self._config_dirs, self._keys = root, config_dirs, keys
        self._chosen: Mapping[str, Any] = config.hydra.runtime.choices
        self._config = OmegaConf.masked_copy(config, [str(key) for key in config if key != "hydra"])
        OmegaConf.set_struct(self._config, True)
        first = self.compose([0] * len(keys))
        self._first, self.choices = first.resolved, first.choices
        self._changes = self._find_changes()
        self._keys_of: dict[str, list[int]] = {}  # numbers of the keys that change something in a group
        for index, changes in enumerate(self._changes or ()):
            for name in dict.fromkeys(place[0] for each in _distinct(changes) for place in each):
                self._keys_of.setdefault(name, []).append(index)
        self._groups: dict[tuple[object, ...], object] = {}

    def resolve(self, cell: Sequence[int]) -> Mapping[str, Any]:
        """Return the resolved config of a cell, given by the number of each key's value.

        Cells for which a group is the same share it as one object, which must not be changed.

        Raises:
            ConfigError: if it does not compose.
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
        """Tell whether all that the values of a key do is to stand in one place, which no other key changes."""
        if self._changes is None:
            return False
        alone = all(not each or list(each) == [place] for each in _distinct(self._changes[key]))
        return alone and self._keys_of.get(place[0]) == [key]

    def _group(self, name: str, numbers: Sequence[int]) -> object:
        """Return what the root of the config holds under a name, given by the numbers of the keys that change it."""
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
        """Compose a cell by Hydra's own function for overrides of values; see `resolve`."""
        texts = [key.override(number) for key, number in zip(self._keys, cell, strict=True)]
        config = copy.deepcopy(self._config)
        try:
            put_values(config, texts)
        except COMPOSITION_ERRORS as error:
            raise explain(error, self._config_dirs) from None
        return from_hydra(config, self._chosen, texts, self._config_dirs)

    def _find_changes(self) -> "list[Sequence[Changes]] | None":
        """Return what each value of each key changes against the first cell, or None where keys act on each other.

        They do where two keys change one place; they may where values are mappings, which merge, or interpolations.
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
        places = change(other)
        if all(
            repr(value) == repr(key.values[other]) and repr(get(self._first, place)) == repr(first)
            for place, value in places.items()
        ):
            return _Same(list(places), key.values)
        return [change(number) for number in range(len(key.values))]


class _Same(Sequence[Changes]):
    """Each value of a key put into the same places, made when asked for, as a key may have a million of them."""

    def __init__(self, places: Sequence[Place], values: Sequence[Any]) -> None:
        self._places, self._values = places, values

    def __len__(self) -> int:
        return len(self._values)

    def __getitem__(self, number: Any) -> Any:
        return dict.fromkeys(self._places, self._values[number])


def _distinct(changes: Sequence[Changes]) -> Sequence[Changes]:
    """Return changes, without those that are known to be in the same places as others."""
    return [changes[0]] if isinstance(changes, _Same) else changes


def _is_plain(value: Any) -> bool:
    if isinstance(value, list):
        return all(_is_plain(part) for part in value)
    if isinstance(value, str):
        return "$" not in value and "\\" not in value
    return value is None or isinstance(value, bool | int | float)


def _difference(first: Any, other: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Yield where two configs differ, and the other's value there; _GONE for a key that the other lacks."""
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
    """Put a value into a config of which only the root is a copy; copies what lies on the way."""
    for key in place[:-1]:
        inner = dict(config[key])
        config[key] = inner
        config = inner
    config[place[-1]] = value


def _overlap(one: Place, other: Place) -> bool:
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]
