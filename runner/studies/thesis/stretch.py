"""Loss of the goal under two-way coupling, and the sinking speed of the Macro before it."""

import numpy as np

from runner.store import Run
from runner.studies.thesis.folding import missing_acceleration
from runner.study.prose.signals import norm, vector

_SETTLED = 1e-3  # m, of the tip error, from where on the drift is measured
_WAY_LEFT = norm(vector("desired") - vector("macro_tip"))  # m, from the Macro's end point to the target
_LONGEST = 0.5  # s, over which it is measured, before the reach is lost


def lost_from(run: Run) -> float | None:
    """Return the time from which on the target is out of reach, in s; None where it is not at the end."""
    beyond = _WAY_LEFT(run) > _reach(run)
    if not beyond[-1]:
        return None
    inside = np.flatnonzero(~beyond)
    return float(run.t[inside[-1] + 1]) if len(inside) else 0.0


def lost_from_text(run: Run) -> str:
    """Return the same for a table."""
    lost = lost_from(run)
    return "never" if lost is None else f"{lost:.2f}"


def share_beyond(run: Run) -> float:
    """Return for which share of a run the target is out of reach, in %."""
    return 100.0 * float(np.mean(_WAY_LEFT(run) > _reach(run)))


def left_out(run: Run) -> float | None:
    """Return the acceleration by what the Macro's law leaves out while the drift is measured, in m/s^2."""
    window = _window(run)
    return None if window is None else missing_acceleration(run, sum(window) // 2)


def predicted(run: Run) -> float | None:
    """Return the speed at which the Macro's damping bears it, in m/s."""
    missing, controller = left_out(run), run.config["controller"]
    damping = 2.0 * float(controller["damping_ratio"]["macro"]) * float(controller["natural_frequency"]["macro"])
    return None if missing is None else missing / damping


def drift(run: Run) -> float | None:
    """Return the mean speed of the Macro's end point while the tip rests at the goal, in m/s."""
    window = _window(run)
    if window is None:
        return None
    (first, last), t, moved = window, run.t, run.vector("macro_tip")
    return float(np.linalg.norm(moved[last] - moved[first]) / (t[last] - t[first]))


def _reach(run: Run) -> float:
    return float(run.config["controller"]["reach"])


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
