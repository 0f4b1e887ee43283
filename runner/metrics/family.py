"""Interface of a metric family, built-in or from a plug-in, and the context of its metrics."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from runner.base.arrays import FloatArray
from runner.base.trace import Trace, Traces
from runner.trajectories.trajectory import Trajectory


@dataclass(frozen=True)
class MetricContext:
    """The setting of a run.

    Attributes:
        trajectory: The desired motion.
        settling_band: Largest error on each axis of an arm that has settled, in m.
        period: Time between two rows of the trace, in s.
        reach: Distance of the target from a riding stage's base up to which it follows it, in m; None where no
            controller has such a limit.
    """

    trajectory: Trajectory
    settling_band: float
    period: float
    reach: float | None = None


class OwnFamily(Protocol):
    """Metrics of ours that belong together, of several runs at once."""

    @property
    def UNITS(self) -> Mapping[str, str]:  # noqa: N802 - a constant of the module
        """Unit of each metric by name, without the suffixes of joints and axes."""
        ...

    def evaluate(self, traces: Traces, context: MetricContext) -> Mapping[str, FloatArray]:
        """Return the metrics by name, each of shape (runs,); NaN for a run that has no value."""
        ...


@runtime_checkable
class MetricFamily(Protocol):
    """Metrics of a plug-in that belong together."""

    __name__: str

    @property
    def UNITS(self) -> Mapping[str, str]:  # noqa: N802 - a constant of the module
        """Unit of each metric by name, without the suffixes of joints and axes."""
        ...

    def evaluate(self, trace: Trace, context: MetricContext) -> Mapping[str, float | None]:
        """Return the metrics of one run by name; None for one without a value."""
        ...
