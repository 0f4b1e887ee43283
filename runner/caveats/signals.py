"""What rules look at in a run, or in many."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from runner.trace import FloatArray, Trace


@dataclass(frozen=True)
class Signals:
    """Signals and metrics of a run, a row for each control tick; axes of several runs may stand in front of each array.

    Attributes:
        q: Joint positions, shape (..., T, nq), in rad.
        tau: Torques that were held, shape (..., T - 1, nq), in N m.
        tip: Tip positions, shape (..., T, 3), in m.
        desired: Desired tip positions, likewise.
        saturation: Share of the ticks that each joint is at its torque limit, shape (..., nq).
    """

    q: FloatArray
    tau: FloatArray
    tip: FloatArray
    desired: FloatArray
    saturation: FloatArray

    @property
    def runs(self) -> int:
        """Number of runs."""
        return math.prod(self.q.shape[:-2])


def signals_of(trace: Trace, metrics: Mapping[str, float | None]) -> Signals:
    """Return what rules look at in one run that did not fail."""
    shares = [metrics[f"saturation_fraction_q{joint + 1}"] for joint in range(trace.q.shape[1])]
    return Signals(trace.q, trace.tau[:-1], trace.tip, trace.desired[:, 0], np.array(shares, dtype=np.float64))
