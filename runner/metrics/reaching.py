"""Whether a riding arm could follow."""

import numpy as np

from runner.metrics.context import MetricContext
from runner.trace import Trace

UNITS = {"reach_loss_fraction": "1"}


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return what a riding arm could not follow; absent for a robot of one stage.

    - reach_loss_fraction: share of ticks at which x_d is out of the last stage's reach.
    """
    if context.reach is None or len(trace.stage_names) < 2:
        return {}
    rest = np.linalg.norm(trace.desired[:, 0] - trace.end_points[-2], axis=1)
    return {"reach_loss_fraction": float((rest > context.reach).mean())}
