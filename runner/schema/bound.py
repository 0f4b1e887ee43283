"""Ranges of numbers with their verdict and their words, and bounds on metrics."""

import math
import sys
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, Self

from pydantic import model_validator

from runner.schema.model import StrictModel


class Range(NamedTuple):
    """Range of numbers to which its ends belong; an end is a number, or an array for several ranges.

    Attributes:
        low: Lower end; without one every finite number is high enough.
        high: Upper end; without one every finite number is low enough.
    """

    low: Any = -sys.float_info.max
    high: Any = sys.float_info.max

    @classmethod
    def between(cls, low: float | None, high: float | None) -> "Range":
        """Return a range by its ends; None for no end."""
        return cls(cls().low if low is None else low, cls().high if high is None else high)

    def holds(self, values: Any) -> Any:
        """Return whether a number, or each of an array, is in the range; NaN, a missing value, is not."""
        return (self.low <= values) & (values <= self.high)

    def exceeded(self, values: Any) -> Any:
        """Return whether a number, or each of an array, is above the range; NaN is not."""
        return values > self.high

    def verdict(self, value: float | None) -> Literal["below", "within", "above"]:
        """Return where a number lies; None, no value, counts as above every number."""
        number = math.inf if value is None else value
        return "above" if self.exceeded(number) else "below" if number < self.low else "within"

    def text(self, show: Callable[[float], object], between: Callable[[float, float], object] | None = None) -> str:
        """Return the range in words, such as "at most 1.6 s", with functions for one number and for both ends."""
        low, high = (abs(end) < sys.float_info.max for end in self)
        if low and high:
            return str(between(*self)) if between else f"{show(self.low)} to {show(self.high)}"
        return f"at least {show(self.low)}" if low else f"at most {show(self.high)}" if high else "none"


class Bound(StrictModel):
    """Closed range of a metric.

    Attributes:
        min: Lower end, in the metric's unit; no lower end if omitted or null.
        max: Upper end, in the metric's unit; no upper end if omitted or null.
        reason: Reason for the bound; may be omitted.
    """

    min: float | None = None
    max: float | None = None
    reason: str = ""

    @model_validator(mode="after")
    def _check_ends(self) -> Self:
        if self.min is None and self.max is None:
            raise ValueError("needs min, max or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min {self.min:g} is above max {self.max:g}")
        return self

    @property
    def range(self) -> Range:
        """The range between the ends."""
        return Range.between(self.min, self.max)
