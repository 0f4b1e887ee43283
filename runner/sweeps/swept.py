"""Overrides of a sweep: the swept keys and their values."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hydra.core.config_loader import ConfigLoader
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override, RangeSweep, Transformer

from runner.base.errors import ConfigError
from runner.base.limits import CELLS
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.units import as_numbers
from runner.store.axes import SweepAxis


@dataclass(frozen=True)
class SweptKey:
    """A key of a sweep's command line with its values; one that is not swept has one.

    Attributes:
        name: The key, such as "noise.position".
        values: Its values; quantities, such as 1mrad, as numbers in SI units.
        option: Whether they choose an option of a config group, or delete a key: what needs composing anew.
        start: How its overrides begin for Hydra, such as "noise.position".
        typed: The override as typed; empty for a key that is swept.
    """

    name: str
    values: Sequence[Any]
    option: bool
    start: str
    typed: str = ""

    def override(self, number: int) -> str:
        """Return the override of a value as Hydra takes it; the value is given by its number."""
        return self.typed or SweepAxis(self.start, self.values).text(number)

    def entry(self) -> SweepAxis | str:
        """Return the key as an entry of a sweep's axes."""
        if len(self.values) == 1:
            return self.override(0)
        return SweepAxis(self.start, self.values)


def parse_sweep(arguments: Sequence[str], groups: Sequence[str], loader: ConfigLoader) -> list[SweptKey]:
    """Return the keys of a sweep in order; of a key that stands twice the last values count, in the first place.

    Args:
        arguments: Overrides, such as "robot=macro,mini" and "noise.position=1e-4,1e-3".
        groups: Names of the config groups.
        loader: Hydra's loader, which knows what `glob(*)` stands for.

    Raises:
        ConfigError: for what is not a valid override, for a key that is swept over no value, and for too many cells.
    """
    try:
        overrides = OverridesParser.create(config_loader=loader).parse_overrides(list(arguments))
        _check_ranges(overrides)
        keys = {override.get_key_element(): _read(override, groups) for override in overrides}
    except COMPOSITION_ERRORS as error:
        raise explain(error) from None
    empty = [f"{key.name}: is swept over no value; give one or more" for key in keys.values() if not key.values]
    if empty:
        raise ConfigError(empty)
    _check_cells(math.prod(len(key.values) for key in keys.values()))
    return list(keys.values())


def _check_ranges(overrides: Sequence[Override]) -> None:
    """Refuse a range of too many values before they are written out."""
    for override in overrides:
        value = override.value()
        if isinstance(value, RangeSweep) and value.start is not None and value.stop is not None and value.step:
            _check_cells((value.stop - value.start) / value.step)


def _check_cells(cells: float) -> None:
    if excess := CELLS.excess(cells):
        raise ConfigError([f"the sweep {excess}; sweep over fewer values"])


def _read(override: Override, groups: Sequence[str]) -> SweptKey:
    name, start = override.key_or_group, override.get_key_element()
    is_group = name in groups or "/" in name or override.package is not None
    values: Sequence[Any] | None = _counted(override)
    if values is None and override.is_sweep_override():
        values = [Override._convert_value(value) for value in override.sweep_iterator(Transformer.identity)]
    typed = "" if values is not None else override.input_line or ""
    values = [override.value()] if values is None else values
    numbers = None if is_group or isinstance(values, range) else as_numbers(values, name)
    if numbers is not None:
        return SweptKey(name, numbers, option=False, start=start)
    mapping = not isinstance(values, range) and any(isinstance(value, dict) for value in values)
    return SweptKey(name, values, (is_group and not mapping) or override.is_delete(), start, typed)


def _counted(override: Override) -> range | None:
    """Return the values of a range of whole numbers in order, which may be a million; None of any other override."""
    value = override.value()
    if not isinstance(value, RangeSweep) or value.shuffle or value.tags:
        return None
    values = value.range()
    return values if isinstance(values, range) else None
