"""Picture on the first screen of a study's report: the arm in motion."""

import numpy as np

from runner.reporting.charts.moving_arm import moving_arm
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.document import Cover
from runner.reporting.figures import columns, joint_columns, model_of, playback, until_time
from runner.store import Run

_FRAMES = 60


def cover(run: Run, caption: str, until: float | None = None) -> Cover:
    """Return the picture of a run for the first screen.

    Args:
        run: The run.
        caption: What moves.
        until: End of the part shown, in s; None shows it all.
    """
    trace = until_time(run, until)
    trace = trace[np.isfinite(joint_columns(trace, "q")).all(axis=1)]
    q, t, tip = joint_columns(trace, "q"), trace["t"].to_numpy(), columns(trace, "tip")
    few, path = spaced_indices(len(t), _FRAMES), spaced_indices(len(t), 5 * _FRAMES)
    desired = columns(trace, "desired")[path]
    moving = moving_arm(model_of(run), q[few], float(t[-1] - t[0]), tip[path], desired)
    return Cover(caption, moving, playback(run, caption, until).still)
