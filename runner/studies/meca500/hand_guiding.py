"""Distance, remaining position error and damping force of a tool under hand guiding."""

import numpy as np

from runner.reporting.figures import columns
from runner.store import Run

_PEAK_OVER_MEAN = 1.875  # speed of a quintic from rest to rest


def guided(run: Run) -> dict[str, float]:
    """Return the hand's way and how far from its end the tip is left, in m, and the damping at its peak speed, in N."""
    hand, tip = run.config["environment"], columns(run.trace, "tip")
    way = float(np.linalg.norm(hand["displacement"]))
    damping = _PEAK_OVER_MEAN * way / float(hand["duration"]) * float(run.config["controller"]["damping"][0])
    return {
        "way": way,
        "left": float(np.linalg.norm(tip[-1] - tip[0] - np.array(hand["displacement"]))),
        "damping": damping,
    }
