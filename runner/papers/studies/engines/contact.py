"""Impact compared with its closed form, and contact of a tool with walls, on every plant."""

import math
from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.study.results import Runs
from runner.store import Run

_ALONG = 1  # the hammer's joint that hits, counted from 0


def impact(run: Run) -> dict[str, float]:
    """Return numbers of a head's first touch of a wall, compared with the closed form.

    The ratio of the speeds of leaving and of touch, what is lost of it, and by which share the largest force is above
    the closed form; by which share, without sign, the wall's impulse is off what the head's change of speed and the
    force that drives it ask for; off_size is that of the largest force without sign.
    """
    force = _wall_force(run)
    touching = np.flatnonzero(force > 0.0)
    first = int(touching[0])
    last = first + int(np.argmax(force[first:] <= 0.0)) - 1
    speed, h = run.joints("dq")[:, _ALONG], float(run.config["controller"]["period"])
    before, after = float(speed[first - 1]), float(speed[last + 1])
    peak, drive = float(force[first : last + 1].max()), float(run.config["controller"]["torques"][_ALONG])
    asked = mass(run) * (before - after) + drive * h * (last + 1 - (first - 1))
    off = peak / closed_form_peak(run) - 1.0
    impulse = float(force[first - 1 : last + 2].sum()) * h
    return {
        "restitution": -after / before,
        "lost": 1.0 + after / before,
        "off": off,
        "off_size": abs(off),
        "impulse_off": abs(impulse / asked - 1.0),
    }


def mass(run: Run) -> float:
    """Return the mass of the head with its tool, in kg."""
    return float(run.model.mass_matrix(np.zeros(2))[_ALONG, _ALONG])


def closed_form_peak(run: Run) -> float:
    """Return the largest force of an undamped wall on a head under a constant force F, in N.

    It comes with m v^2 / 2 = F d, and the spring takes that and the energy that F adds on its way:
    f = F + sqrt(F^2 + k m v^2).
    """
    wall, drive = run.config["environment"], float(run.config["controller"]["torques"][_ALONG])
    return drive + math.sqrt(drive**2 + 2.0 * float(wall["stiffness"]) * drive * float(wall["distance"]))


def restitution_by_step(runs: Runs, run: str, share: float) -> Callable[[float], float]:
    """Return 1 + s pi w h over the step h, the restitution of half a period at w = sqrt(k / m), to first order.

    The share s is -1/2 for a spring that is solved at the end of each step, which loses what a damper of k h loses, and
    1/4 for one whose force is held for each step, on average half a step late.
    """
    stiffness = float(runs[run].config["environment"]["stiffness"])
    return lambda h: 1.0 + share * math.pi * math.sqrt(stiffness / mass(runs[run])) * h


def unrest(run: Run) -> float:
    """Return the peak-to-peak force in the last tenth of a run, in N."""
    force = _wall_force(run)
    return float(np.ptp(force[-len(force) // 10 :]))


def _wall_force(run: Run) -> FloatArray:
    return -run.signal("external_force_x")
