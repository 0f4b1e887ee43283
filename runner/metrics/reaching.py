"""Reach metric: fraction of control steps with the target out of reach of the last stage."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Trace
from runner.metrics.family import MetricContext

UNITS = {"reach_loss_fraction": "1"}


def evaluate(traces: Trace, context: MetricContext) -> dict[str, FloatArray]:
    """Return the reach loss of the last stage; empty for a robot with one stage.

    - reach_loss_fraction: fraction of ticks at which x_d is out of reach of the last stage.
    """
    if context.reach is None or len(traces.stage_names) < 2:
        return {}
    way = traces.desired[..., 0, :] - traces.end_points[-2]
    rest = np.sqrt(way[..., 0] ** 2 + way[..., 1] ** 2 + way[..., 2] ** 2)
    return {"reach_loss_fraction": np.count_nonzero(rest > context.reach, axis=1) / len(traces.t)}
