"""Contact metrics: peak force, steady force and force error."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Trace
from runner.metrics.family import MetricContext

UNITS = {"peak_force": "N", "steady_force": "N", "force_error": "N"}
_STEADY_WINDOW = 0.5  # s, at the end of the run


def evaluate(traces: Trace, context: MetricContext) -> dict[str, FloatArray]:
    """Return the contact forces of a single run; empty for a run without an external wrench.

    - peak_force: largest magnitude of the environment's force on the tip.
    - steady_force: magnitude of the mean force of the environment over the last 0.5 s; None for a shorter run.
    - force_error: magnitude of the difference between the mean force that the controller used and the mean force of
      the environment, over the last 0.5 s; None for a shorter run.
    """
    if traces.contact is None:
        return {}
    force, felt = traces.contact.external[:, :3], traces.contact.felt[:, :3]
    steady = traces.t >= traces.t[-1] - _STEADY_WINDOW - 1e-9
    long_enough = bool(traces.t[-1] >= _STEADY_WINDOW - 1e-9)
    mean = force[steady].mean(axis=0)
    values = {
        "peak_force": np.linalg.norm(force, axis=1).max(),
        "steady_force": np.linalg.norm(mean) if long_enough else np.nan,
        "force_error": np.linalg.norm(felt[steady].mean(axis=0) - mean) if long_enough else np.nan,
    }
    return {name: np.array([value], dtype=np.float64) for name, value in values.items()}
