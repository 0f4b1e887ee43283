"""What the module of a family of metrics offers."""

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

from runner.metrics.context import MetricContext
from runner.trace import Trace


@runtime_checkable
class MetricFamily(Protocol):
    """Metrics that belong together."""

    __name__: str

    @property
    def UNITS(self) -> Mapping[str, str]:  # noqa: N802 - a constant of the module
        """Unit of each metric by name, without the suffixes of joints and axes."""
        ...

    def evaluate(self, trace: Trace, context: MetricContext) -> Mapping[str, float | None]:
        """Return the metrics of one run by name; None for one without a value."""
        ...
