"""Signals of one or several runs for the caveat rules."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Trace, Traces


@dataclass(frozen=True)
class Signals:
    """Signals and metrics of a run, a row for each control tick; axes of several runs may stand in front.

    Attributes:
        q: Joint positions, shape (..., T, nq), in rad.
        tau: Torques that were held, shape (..., T - 1, nq), in N m.
        tip: Tip positions, shape (..., T, 3), in m.
        desired: Desired tip positions, likewise.
        saturation: Share of the ticks that each joint is at its torque limit, shape (..., nq).
        limits: Torque limit of each joint, shape (..., nq), in N m; infinite where there is none.
    """

    q: FloatArray
    tau: FloatArray
    tip: FloatArray
    desired: FloatArray
    saturation: FloatArray
    limits: FloatArray

    def part(self, first: int, last: int) -> "Signals":
        """Return the runs on the first axis from one to before another."""
        return Signals(**{name: value[first:last] for name, value in vars(self).items()})


def signals_of(trace: Trace | Traces, metrics: Mapping[str, float | FloatArray | None]) -> Signals:
    """Return what rules look at in a run that did not fail, or in several, which then stand on the first axis.

    Args:
        trace: The run, or the runs.
        metrics: Its metrics, or arrays of theirs.
    """
    shares = [metrics[f"saturation_fraction_q{joint + 1}"] for joint in range(len(trace.joint_names))]
    tip = trace.end_points[-1]
    return Signals(
        q=trace.q,
        tau=trace.tau[..., :-1, :],
        tip=tip,
        desired=np.broadcast_to(trace.desired[..., 0, :], tip.shape),
        saturation=np.array(shares, dtype=np.float64).T,
        limits=trace.limits,
    )
