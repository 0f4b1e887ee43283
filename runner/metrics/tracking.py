"""How closely the tip follows a moving target."""

import numpy as np

from runner.metrics.context import MetricContext
from runner.trace import Trace

UNITS = {"max_tracking_error": "m", "rms_tracking_error": "m", "cross_track_error": "m"}


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return the tracking errors; those over 0..t_f are absent for a goal.

    - max_tracking_error, and _x, _y, _z: largest axis error over 0..t_f.
    - rms_tracking_error: root mean square of the error's norm over 0..t_f.
    - cross_track_error: largest distance to the path taken as a curve, over the whole run.
    """
    cross_track = {"cross_track_error": float(context.trajectory.distance_to_path(trace.tip).max())}
    if not context.trajectory.tracked:
        return dict(cross_track)
    error = trace.error[trace.t <= context.trajectory.duration + 1e-9]
    axes = np.abs(error).max(axis=0)
    return {
        "max_tracking_error": float(axes.max()),
        **{f"max_tracking_error_{axis}": float(value) for axis, value in zip("xyz", axes, strict=True)},
        "rms_tracking_error": float(np.sqrt((error**2).sum(axis=1).mean())),
        **cross_track,
    }
