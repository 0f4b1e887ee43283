"""Bound on a metric."""

import math
from typing import Self

from pydantic import model_validator

from runner.schema.model import StrictModel


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

    def holds(self, value: float) -> bool:
        """Return True if a value is within the bound; False for NaN, a missing value."""
        low = -math.inf if self.min is None else self.min
        high = math.inf if self.max is None else self.max
        return low <= value <= high
