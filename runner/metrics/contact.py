"""How strongly the tip and the world pushed each other."""

import numpy as np

from runner.metrics.context import MetricContext
from runner.trace import Trace

UNITS = {"peak_force": "N", "steady_force": "N", "force_error": "N"}
_STEADY_WINDOW = 0.5  # s, at the end of the run


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return the forces between tip and world; none where there was nothing to feel.

    - peak_force: largest magnitude of the world's force on the tip.
    - steady_force: its mean over the last 0.5 s; None for a shorter run.
    - force_error: distance of what the controller felt from it, likewise averaged.
    """
    if trace.contact is None:
        return {}
    force, felt = trace.contact.external[:, :3], trace.contact.felt[:, :3]
    steady = trace.t >= trace.t[-1] - _STEADY_WINDOW - 1e-9
    long_enough = bool(trace.t[-1] >= _STEADY_WINDOW - 1e-9)
    mean = force[steady].mean(axis=0)
    return {
        "peak_force": float(np.linalg.norm(force, axis=1).max()),
        "steady_force": float(np.linalg.norm(mean)) if long_enough else None,
        "force_error": float(np.linalg.norm(felt[steady].mean(axis=0) - mean)) if long_enough else None,
    }
