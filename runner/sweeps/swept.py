"""Overrides of a sweep: the swept keys and their values."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from hydra.core.config_loader import ConfigLoader
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override, RangeSweep, Transformer

from runner.base.errors import ConfigError
from runner.base.limits import CELLS
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
        option: True if the values choose an option of a config group or delete a key; such overrides need a new
            composition.
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


def parse_sweep(arguments: Sequence[str | SweepAxis], groups: Sequence[str], loader: ConfigLoader) -> list[SweptKey]:
    """Return the keys of a sweep in order. A repeated key has its last values at its first position.

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
    keys = {key.start: key for key in entries}
    _check_cells(math.prod(len(key.values) for key in keys.values()))
    return list(keys.values())


def read_keys(arguments: Sequence[str], groups: Sequence[str], loader: ConfigLoader) -> list[SweptKey]:
    """Return the key of each prepared override with its values; see `parse_sweep`."""
    try:
        overrides = OverridesParser.create(config_loader=loader).parse_overrides(list(arguments))
        _check_ranges(overrides)
        keys = [_read(override, groups) for override in overrides]
    except COMPOSITION_ERRORS as error:
        raise explain(error) from None
    if empty := [f"{key.name}: is swept over no value; give one or more" for key in keys if not key.values]:
        raise ConfigError(empty)
    return keys


def _check_ranges(overrides: Sequence[Override]) -> None:
    """Raise an error for a range with too many values before it is expanded."""
    for override in overrides:
        value = override.value()
        if isinstance(value, RangeSweep) and value.start is not None and value.stop is not None and value.step:
            _check_cells((value.stop - value.start) / value.step)


def _check_cells(cells: float) -> None:
    if excess := CELLS.excess(cells):
        raise ConfigError(f"the sweep {excess}; sweep over fewer values")


def _read(override: Override, groups: Sequence[str]) -> SweptKey:
    values: Sequence[Any] | None = _counted(override)
    if values is None and override.is_sweep_override():
        values = [Override._convert_value(value) for value in override.sweep_iterator(Transformer.identity)]
    typed = "" if values is not None else override.input_line or ""
    values = [override.value()] if values is None else values
    key = _key(override.key_or_group, override.get_key_element(), values, groups, typed)
    return replace(key, option=True) if override.is_delete() else key


def _key(name: str, start: str, values: Sequence[Any], groups: Sequence[str], typed: str = "") -> SweptKey:
    is_group = name in groups or "/" in name or "@" in start
    if isinstance(values, range):
        return SweptKey(name, values, is_group, start, typed)
    numbers = None if is_group else as_numbers(values, name)
    if numbers is not None:
        return SweptKey(name, numbers, option=False, start=start)
    return SweptKey(name, values, is_group and not any(isinstance(value, dict) for value in values), start, typed)


def _counted(override: Override) -> range | None:
    """Return the values of an ordered integer range, which may have a million values; None for other overrides."""
    value = override.value()
    if not isinstance(value, RangeSweep) or value.shuffle or value.tags:
        return None
    values = value.range()
    return values if isinstance(values, range) else None
