"""How soon and how closely the tip comes to rest at its goal."""

import numpy as np

from runner.metrics.context import MetricContext
from runner.trace import Trace

UNITS = {"settling_time": "s", "steady_state_error": "m", "overshoot": "m"}
_STEADY_WINDOW = 0.5  # s, at the end of the run


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return settling time, steady-state error and overshoot.

    - settling_time: first tick after the last one with any axis error beyond the band; 0 if never beyond, None if
      still beyond at the end.
    - steady_state_error: largest axis error over the last 0.5 s; None when less than 0.5 s lies after t_f, or
      the motion is periodic.
    - overshoot: largest distance past the goal along the direction from start to goal, less how far the desired motion
      itself goes there; None without a goal.
    """
    worst = np.abs(trace.error).max(axis=1)
    goal = context.trajectory.goal
    return {
        "settling_time": _settling_time(trace.t, worst > context.settling_band),
        "steady_state_error": None if goal is None else _steady_state_error(trace, worst, context.trajectory.duration),
        "overshoot": None if goal is None else _overshoot(trace, context.trajectory.start, goal),
    }


def _settling_time(t: np.ndarray, beyond: np.ndarray) -> float | None:
    rows = np.flatnonzero(beyond)
    if len(rows) == 0:
        return 0.0
    return None if rows[-1] == len(t) - 1 else float(t[rows[-1] + 1])


def _steady_state_error(trace: Trace, worst: np.ndarray, t_f: float) -> float | None:
    first = trace.t[-1] - _STEADY_WINDOW
    if first < t_f - 1e-9:
        return None
    return float(worst[trace.t >= first - 1e-9].max())


def _overshoot(trace: Trace, start: np.ndarray, goal: np.ndarray) -> float:
    distance = float(np.linalg.norm(goal - start))
    if distance == 0.0:
        return 0.0
    along = (goal - start) / distance
    past, wanted = (float(((points - goal) @ along).max()) for points in (trace.tip, trace.desired[:, 0]))
    return max(0.0, past - max(0.0, wanted))
