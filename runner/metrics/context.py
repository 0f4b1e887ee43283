"""Context of the metrics: desired motion, settling band, period and reach."""

from dataclasses import dataclass

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
