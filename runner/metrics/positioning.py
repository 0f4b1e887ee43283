"""Positioning metrics: settling time, steady-state error and overshoot."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Trace
from runner.metrics.family import MetricContext
from runner.trajectories.geometry import component

UNITS = {"settling_time": "s", "steady_state_error": "m", "overshoot": "m"}
STEADY_WINDOW = 0.5  # s, at the end of the run


def evaluate(traces: Trace, context: MetricContext) -> dict[str, FloatArray]:
    """Return settling time, steady-state error and overshoot.

    - settling_time: first tick after the last one with any axis error beyond the band; 0 if the error never exceeds the
      band, None if it still does at the end.
    - steady_state_error: largest error on any axis over the last 0.5 s; None if the run ends less than 0.5 s after t_f
      or the motion is periodic.
    - overshoot: largest distance past the goal in the direction from start to goal, minus that of the desired motion;
      None without a goal.
    """
    worst = np.abs(traces.error_by_axis).max(axis=1)
    goal, none = context.trajectory.goal, np.full(len(traces.q), np.nan)
    return {
        "settling_time": _settling_time(traces.t, worst > context.settling_band),
        "steady_state_error": (
            none if goal is None else _steady_state_error(traces.t, worst, context.trajectory.duration)
        ),
        "overshoot": none if goal is None else _overshoot(traces, context.trajectory.start, goal),
    }


def _settling_time(t: FloatArray, beyond: np.ndarray) -> FloatArray:
    after = len(t) - np.argmax(beyond[:, ::-1], axis=1)  # the tick after the last one beyond
    settled = np.append(t, np.nan)[after]
    return np.where(beyond.any(axis=1), settled, 0.0)


def _steady_state_error(t: FloatArray, worst: FloatArray, t_f: float) -> FloatArray:
    first = t[-1] - STEADY_WINDOW
    if first < t_f - 1e-9:
        return np.full(len(worst), np.nan)
    steady: FloatArray = worst[:, np.searchsorted(t, first - 1e-9) :].max(axis=1)
    return steady


def _overshoot(traces: Trace, start: FloatArray, goal: FloatArray) -> FloatArray:
    distance = float(np.linalg.norm(goal - start))
    if distance == 0.0:
        return np.zeros(len(traces.q))
    along = (goal - start) / distance
    past, wanted = (
        component(points.swapaxes(-1, -2) - goal, along).max(axis=-1)
        for points in (traces.tip_by_axis, traces.target_by_axis)
    )
    overshoot: FloatArray = np.maximum(past - np.maximum(wanted, 0.0), 0.0) + 0.0  # no -0.0
    return overshoot
