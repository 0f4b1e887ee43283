"""Overrides of a sweep: the swept keys and their values."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from typing import Any

from hydra.core.config_loader import ConfigLoader
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import (
    ChoiceSweep,
    Glob,
    IntervalSweep,
    Override,
    RangeSweep,
    Sweep,
    Transformer,
    ValueType,
)

from runner.base.errors import ConfigError
from runner.base.limits import CELLS
from runner.base.sanitize import quoted
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.overrides import prepare
from runner.config.compose.units import as_numbers
from runner.store.axes import SweepAxis


@dataclass(frozen=True)
class SweptKey:
    """Key of a sweep's command line with its values; a key that is not swept has one value.

    Attributes:
        name: The key, such as "noise.position".
        values: Values of the key; quantities, such as 1mrad, are numbers in SI units.
        option: True if a value chooses or deletes an option of a config group; see `chooses`.
        start: First part of Hydra's override, such as "noise.position".
        typed: Override as typed; empty for a swept key.
    """

    name: str
    values: Sequence[Any]
    option: bool
    start: str
    typed: str = ""

    def override(self, number: int) -> str:
        """Return the Hydra override of a value, given by its index."""
        return self.typed or SweepAxis(self.start, self.values).text(number)

    def entry(self) -> SweepAxis | str:
        """Return the key as an entry of a sweep's axes."""
        if len(self.values) == 1:
            return self.override(0)
        return SweepAxis(self.start, self.values)

    def chooses(self, number: int) -> bool:
        """Return True if a value, given by its index, needs a new composition; a mapping sets keys of any option."""
        return self.option and not isinstance(self.values[number], Mapping)

    def only(self, number: int) -> "SweptKey":
        """Return the key with one of its values, given by its index."""
        return replace(self, values=[self.values[number]], option=self.chooses(number))

    def replaces(self, earlier: "SweptKey") -> bool:
        """Return True if the values make those of an earlier entry ineffective.

        Hydra merges a mapping into what is there, so a mapping replaces nothing, and no option replaces a mapping.
        """
        same = self.start == earlier.start and self.option == earlier.option
        return same and not self._has_mapping and not (earlier.option and earlier._has_mapping)

    def needs_order(self, other: "SweptKey") -> bool:
        """Return True if both entries set values, and one sets a part of what the other sets."""
        if any(each.option and not each._has_mapping for each in (self, other)):
            return False
        one, two = f"{self.name}.", f"{other.name}."
        return one.startswith(two) or two.startswith(one)

    @cached_property
    def _has_mapping(self) -> bool:
        return not isinstance(self.values, range) and any(isinstance(value, Mapping) for value in self.values)


def parse_sweep(arguments: Sequence[str | SweepAxis], groups: Sequence[str], loader: ConfigLoader) -> list[SweptKey]:
    """Return the keys of a sweep; see `merge` for repeated keys.

    Args:
        arguments: Overrides, such as "robot=macro,mini" and "noise.position=1e-4,1e-3", and axes with typed values.
        groups: Names of the config groups.
        loader: Hydra's loader, which expands `glob(*)`.

    Raises:
        ConfigError: if an override is not valid, a key is swept over no value, or there are too many cells.
    """
    texts = [each for each in arguments if isinstance(each, str)]
    axes = [each for each in arguments if isinstance(each, SweepAxis)]
    numbers = [axis.values[:1] if isinstance(axis.values, range) else axis.values for axis in axes]  # these are alike
    checked = [axis.text(number) for axis, values in zip(axes, numbers, strict=True) for number in range(len(values))]
    read = iter(read_keys(prepare([*texts, *checked])[: len(texts)], groups, loader))
    entries = [
        next(read) if isinstance(each, str) else _key(each.key, each.key, each.values, groups) for each in arguments
    ]
    keys = merge(entries)
    _check_cells("the sweep", math.prod(len(key.values) for key in keys))
    return keys


def merge(entries: Sequence[SweptKey]) -> list[SweptKey]:
    """Return entries in the order of the command line, without those that a later entry replaces.

    The later entry takes the place of the replaced one. It keeps its own place if an entry between them, such as a
    mapping or a deletion, sets a part of the same value.
    """
    found: list[SweptKey] = []
    for entry in entries:
        place = next((place for place, earlier in enumerate(found) if entry.replaces(earlier)), None)
        if place is None:
            found.append(entry)
        elif any(entry.needs_order(other) for other in found[place + 1 :]):
            found[place:] = [*found[place + 1 :], entry]
        else:
            found[place] = entry
    return found


def read_keys(arguments: Sequence[str], groups: Sequence[str], loader: ConfigLoader) -> list[SweptKey]:
    """Return the key of each prepared override with its values; see `parse_sweep`."""
    try:
        overrides = OverridesParser.create(config_loader=loader).parse_overrides(list(arguments))
        return [_read(override, groups) for override in overrides]
    except COMPOSITION_ERRORS as error:
        raise explain(error) from None


def _check_cells(what: str, cells: float) -> None:
    if excess := CELLS.excess(cells):
        raise ConfigError(f"{what} {excess}; sweep over fewer values")


def _read(override: Override, groups: Sequence[str]) -> SweptKey:
    swept = override.is_sweep_override()
    values = _values(override) if swept else [override.value()]
    name, typed = override.key_or_group, override.input_line or ""
    if not values:
        raise ConfigError(f"{name}: is swept over no value; give one or more")
    if not isinstance(values, range) and any(map(_has_function, values)):
        raise ConfigError(
            f"{name}: a function inside a list of values ({quoted(typed.partition('=')[2])}). "
            "Allowed: one function that has all values, such as choice(1,2,3), or only values, such as 1,2,3"
        )
    return _key(name, override.get_key_element(), values, groups, "" if swept else typed)


def _values(override: Override) -> Sequence[Any]:
    """Return the values of a swept key."""
    found: Any = override.value()
    if isinstance(found, IntervalSweep):
        raise ConfigError(
            f"{override.key_or_group}: an interval has no single values to sweep over ({override.get_value_string()}). "
            "Allowed: values such as 1,2 or range(start,stop,step). `runner tune` searches an interval"
        )
    if isinstance(found, RangeSweep):
        numbers = range_values(override)
        if not found.shuffle:
            return numbers
        override = replace(
            override, _value=ChoiceSweep(list=[*numbers], shuffle=True), value_type=ValueType.CHOICE_SWEEP
        )
    return [Override._convert_value(value) for value in override.sweep_iterator(Transformer.identity)]


def range_values(override: Override) -> Sequence[int] | Sequence[float]:
    """Return the numbers of a range, which excludes its stop.

    They are counted in decimal, with the digits of start and step: range(0.1,0.4,0.1) has 0.1, 0.2 and 0.3. Integers
    stay integers, which are not expanded.

    Raises:
        ConfigError: if the step is 0, an end is not finite, or there are too many numbers.
    """
    name = override.key_or_group
    found: Any = override.value()
    start, stop, step = (Decimal(str(each)) for each in (found.start, found.stop, found.step))
    if step == 0:
        raise ConfigError(f"{name}: the step of a range must not be 0; found {override.get_value_string()}")
    if not any(each.is_nan() for each in (start, stop, step)):
        _check_cells(f"{name}: the range", float((stop - start) / step))
    if not all(each.is_finite() for each in (start, stop, step)):
        raise ConfigError(
            f"{name}: the ends and the step of a range must be finite; found {override.get_value_string()}"
        )
    count = max(0, math.ceil((stop - start) / step))
    if isinstance(found.start, int) and isinstance(found.step, int):
        end = found.stop if isinstance(found.stop, int) else found.start + count * found.step
        return range(found.start, end, found.step)
    return [float(start + number * step) for number in range(count)]


def _has_function(value: object) -> bool:
    """Return True if a value is or contains a function of Hydra, such as choice(1,2)."""
    inner = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    return isinstance(value, Sweep | Glob) or any(map(_has_function, inner))


def _key(name: str, start: str, values: Sequence[Any], groups: Sequence[str], typed: str = "") -> SweptKey:
    is_group = name in groups or "/" in name or "@" in start
    if isinstance(values, range):
        return SweptKey(name, values, is_group, start, typed)
    numbers = None if is_group else as_numbers(values, name)
    if numbers is not None:
        return SweptKey(name, numbers, option=False, start=start)
    return SweptKey(name, values, is_group and not all(isinstance(value, dict) for value in values), start, typed)
