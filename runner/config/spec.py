"""Config of the spec: bounds on metrics."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Self

from pydantic import field_validator, model_validator

from runner.base.errors import nearest
from runner.base.sanitize import quoted
from runner.plugins.metric_units import unit_of, units
from runner.schema.model import StrictModel
from runner.schema.units import Unit

_METRICS = "metrics"


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


class SpecConfig(StrictModel):
    """Bounds on metrics.

    Attributes:
        metrics: Bound of each metric, by name; a name may begin with a stage and end with a joint or axis.
    """

    metrics: dict[str, Bound]

    @field_validator("metrics", mode="before")
    @classmethod
    def _check_names(cls, value: Any) -> Any:
        """Reject unknown names of metrics; only the results show which metrics a run has."""
        if not isinstance(value, Mapping) or not value:
            return value
        known = units()
        wrong = [f"{quoted(name)}{nearest(str(name), known)}" for name in value if unit_of(str(name)) is None]
        if wrong:
            raise ValueError(f"no metric is called {', '.join(wrong)}; metrics: {', '.join(known)}")
        return value

    @classmethod
    def find_unit(cls, path: Sequence[str]) -> Unit | None:
        """Return the unit of a key: an end of a bound has the unit of its metric."""
        if len(path) != len(("metrics", "NAME", "max")) or path[0] != _METRICS or path[2] not in ("min", "max"):
            return None
        unit = unit_of(path[1])
        return None if unit is None else Unit("" if unit == "1" else unit)
