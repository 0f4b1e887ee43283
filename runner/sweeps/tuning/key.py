"""Tuned key: a numeric config key and its range."""

import math
from dataclasses import dataclass
from typing import Any, Literal

from hydra.core.override_parser.types import IntervalSweep, Override, RangeSweep

from runner.base.errors import ConfigError
from runner.config.compose.units import key_unit
from runner.sweeps.swept import range_values

RANGES = (
    "interval(low, high), tag(log, interval(low, high)), int(interval(low, high)) for whole numbers, or "
    "range(start, stop, step) for a grid"
)

_INSIDE = 0.618  # fraction of the range above low; no round number of a user is there
_NEAR_END = 0.02  # fraction of the range
_DIGITS = 9  # digits of a value, so that a trial's command can be read and typed
_DIGITS_ON_GRID = 12


@dataclass(frozen=True)
class TunedKey:
    """Tuned key.

    Attributes:
        name: The key, such as "controller.natural_frequency".
        low: Smallest value of the key.
        high: Largest value of the key.
        step: Distance between two values; None if the key has no grid.
        log: True if the scale of the key is logarithmic.
        integer: True if the key takes only whole numbers.
    """

    name: str
    low: float
    high: float
    step: float | None
    log: bool
    integer: bool

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high)):
            raise ConfigError(f"{self.name}: its range must be finite; found {self.low:g} to {self.high:g}")
        if self.low >= self.high:
            raise ConfigError(f"{self.name}: its range is empty, {self.low:g} to {self.high:g}; low must be below high")
        if self.log and self.low <= 0.0:
            raise ConfigError(f"{self.name}: on a logarithmic scale low must be above 0; found {self.low:g}")

    @property
    def unit(self) -> str:
        """Unit of the key; "1" without one."""
        return key_unit(self.name)

    @property
    def probes(self) -> tuple[float, ...]:
        """Both ends of the range and a value between them."""
        low, high = self.low, self.high
        between = low * (high / low) ** _INSIDE if self.log else low + _INSIDE * (high - low)
        return (self.value(low), self.value(between), self.value(high))

    def value(self, proposed: float) -> float:
        """Return the nearest allowed value to a proposed one: whole, or on the grid, if the key requires it."""
        if self.integer and self.step is None:
            return round(proposed)
        if self.step is not None:
            found = self.low + round((proposed - self.low) / self.step) * self.step
            return round(found) if self.integer else float(f"{found:.{_DIGITS_ON_GRID}g}")
        return min(max(float(f"{proposed:.{_DIGITS}g}"), self.low), self.high)

    def end_near(self, value: float) -> Literal["lower", "upper"] | None:
        """Return the end of the range that is within 2 % of a value on the key's scale; None if neither is."""
        low, high, at = (math.log(each) if self.log else each for each in (self.low, self.high, value))
        share = (at - low) / (high - low)
        return "lower" if share <= _NEAR_END else "upper" if share >= 1.0 - _NEAR_END else None

    def override(self, value: float) -> str:
        """Return the override that sets the key to a value."""
        return f"{self.name}={value!r}"


def read_key(override: Override) -> TunedKey | None:
    """Return the key that an override tunes, or None if the override gives one value.

    Raises:
        ConfigError: if the range is empty or of another kind, or the override gives several values.
    """
    found: Any = override.value()
    if not override.is_sweep_override():
        return None
    name = override.key_or_group
    if isinstance(found, IntervalSweep) and found.tags <= {"log"}:
        ends: tuple[Any, Any] = (found.start, found.end)
        return TunedKey(name, *ends, step=None, log="log" in found.tags, integer=isinstance(ends[0], int))
    if isinstance(found, RangeSweep) and not found.tags:
        values = range_values(override)
        if len(values) < 2:
            raise ConfigError(f"{name}: its range is empty; {found.start} to {found.stop} has no two values")
        integer = all(isinstance(value, int) for value in values)
        return TunedKey(name, values[0], values[-1], step=abs(found.step), log=False, integer=integer)
    raise ConfigError(f"'{override.input_line}' is not a range to tune in; ranges: {RANGES}")
