"""Tracking metrics: errors of the tip and the joints, and distance to the path."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Trace
from runner.metrics.family import MetricContext
from runner.trajectories.trajectory import Trajectory

UNITS = {
    "max_tracking_error": "m",
    "max_axis_error": "m",
    "rms_tracking_error": "m",
    "rms_tracking_error_last_period": "m",
    "rms_tracking_error_period": "m",
    "cross_track_error": "m",
    "max_joint_error": "rad",
    "rms_joint_error": "rad",
}


def evaluate(traces: Trace, context: MetricContext) -> dict[str, FloatArray]:
    """Return the tracking errors; for a goal, only cross_track_error.

    - max_tracking_error: largest norm of the error over 0..t_f; with _x, _y or _z, largest error on that axis.
    - max_axis_error: largest error on any axis over 0..t_f.
    - rms_tracking_error: RMS of the norm of the error over 0..t_f.
    - rms_tracking_error_last_period: RMS of the norm of the error over the last period of a periodic motion.
    - rms_tracking_error_period: RMS of the norm of the error over one period of a periodic motion; the suffix _1, _2,
      _4, _8 and so on is the number of the period.
    - cross_track_error: largest distance to the geometric path over the whole run.
    - max_joint_error: largest error of a revolute joint over 0..t_f; only if the desired motion is a joint motion.
    - rms_joint_error: RMS of the norm of the errors of the revolute joints over 0..t_f; only if the desired motion is a
      joint motion.
    """
    distance = context.trajectory.distance_to_path(traces.tip_by_axis.swapaxes(-1, -2))
    cross_track: dict[str, FloatArray] = {"cross_track_error": distance.max(axis=-1)}
    if not context.trajectory.tracked:
        return cross_track
    ticks = int(np.searchsorted(traces.t, context.trajectory.duration + 1e-9, side="right"))
    error = traces.error_by_axis[:, :, :ticks]
    axes = np.abs(error).max(axis=2)
    squared = _squared(error)
    return {
        "max_tracking_error": np.sqrt(squared.max(axis=1)),
        **{f"max_tracking_error_{axis}": axes[:, index] for index, axis in enumerate("xyz")},
        "max_axis_error": axes.max(axis=1),
        "rms_tracking_error": np.sqrt(squared.sum(axis=1) / ticks),
        **_of_periods(traces, context.trajectory, _squared(traces.error_by_axis)),
        **cross_track,
        **_of_joints(traces, context.trajectory, ticks),
    }


def _squared(error: FloatArray) -> FloatArray:
    """Return the squared norm of the error, shapes (runs, 3, T) to (runs, T), in m^2."""
    return np.asarray(error[:, 0] ** 2 + error[:, 1] ** 2 + error[:, 2] ** 2)


def _of_periods(traces: Trace, path: Trajectory, squared: FloatArray) -> dict[str, FloatArray]:
    """Return the RMS errors of a periodic motion in its last period and in periods 1, 2, 4, 8 and so on."""
    end, period = float(traces.t[-1]), path.duration
    whole = int(end / period + 1e-9)
    if path.goal is not None or not whole:
        return {}
    lasts = {f"period_{2**power}": 2**power * period for power in range(whole.bit_length())}
    return {
        f"rms_tracking_error_{name}": np.sqrt(squared[:, _within(traces.t, last - period, last)].mean(axis=1))
        for name, last in {"last_period": end, **lasts}.items()
    }


def _within(times: FloatArray, after: float, until: float) -> slice:
    return slice(*np.searchsorted(times, (after + 1e-9, until + 1e-9), side="right"))


def _of_joints(traces: Trace, path: Trajectory, ticks: int) -> dict[str, FloatArray]:
    turn = np.array([unit == "rad" for unit in traces.joint_units])
    desired = path.sample_joints(traces.t[:ticks])
    if desired is None or not turn.any():
        return {}
    error = (desired[:, 0] - traces.q[:, :ticks])[:, :, turn]
    return {
        "max_joint_error": np.abs(error).max(axis=(1, 2)),
        "rms_joint_error": np.sqrt((error**2).sum(axis=2).sum(axis=1) / ticks),
    }
