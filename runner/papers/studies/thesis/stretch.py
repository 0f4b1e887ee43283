"""Loss of the goal under two-way coupling, and the sinking speed of the Macro before it."""

import numpy as np

from runner.papers.studies.thesis.figures import lost_from, way_left
from runner.papers.studies.thesis.folding import missing_acceleration
from runner.store import Run

_SETTLED = 1e-3  # m, of the tip error, from where on the drift is measured
_LONGEST = 0.5  # s, over which it is measured, before the reach is lost


def share_beyond(run: Run) -> float:
    """Return the part of a run with the target out of reach, in %."""
    return 100.0 * float(np.mean(way_left(run) > run.config["controller"]["reach"]))


def predicted(run: Run) -> float | None:
    """Return the speed at which the Macro's damping balances the terms that its law omits, in m/s."""
    window, controller = _window(run), run.config["controller"]
    damping = 2.0 * float(controller["damping_ratio"]["macro"]) * float(controller["natural_frequency"]["macro"])
    return None if window is None else missing_acceleration(run, sum(window) // 2) / damping


def drift(run: Run) -> float | None:
    """Return the mean speed of the Macro's end point while the tip rests at the goal, in m/s."""
    window = _window(run)
    if window is None:
        return None
    (first, last), t, moved = window, run.t, run.vector("macro_tip")
    return float(np.linalg.norm(moved[last] - moved[first]) / (t[last] - t[first]))


def _window(run: Run) -> tuple[int, int] | None:
    """Return first and last row of the time over which the drift is measured; None where the tip never rests."""
    t, lost = run.t, lost_from(run)
    good = (np.linalg.norm(run.vector("error"), axis=1) < _SETTLED) & (t <= (t[-1] if lost is None else lost))
    resting = t[good]
    if not len(resting):
        return None
    first = int(np.searchsorted(t, max(resting[0], resting[-1] - _LONGEST)))
    last = int(np.searchsorted(t, resting[-1]))
    return (first, last) if last > first else None
