"""Step response to constant forces, compared with the closed form."""

from collections.abc import Callable
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.controllers.force.admittance_filter import AXES, Admittance
from runner.papers.studies.meca500.figures import added_inertia, displacement, loads_of, once, servo_compliance
from runner.papers.studies.meca500.plan import law_in
from runner.store import Run


@once
def step(run: Run) -> dict[str, Any]:
    """Return the peak as a string, and relative to it the largest distance from the analytic answer and its parts.

    error is that of the answer joined by straight lines, error_at_ticks that only at the ticks, and at_rest that at the
    end. give is the servos' deflection at rest by the closed form, and beyond_give the difference between the two.
    """
    index, times = int(np.flatnonzero(loads_of(run))[0]), np.linspace(0.0, run.t[-1], 3001)
    answer = displacement(run)[:, index]
    joined = np.interp(times, run.t, answer)
    expected, at_ticks = (_expected(run, own)[:, index] for own in (times, run.t))
    error = float(np.abs(joined - expected).max() / np.abs(expected).max())
    at_rest = float(abs(answer[-1] - at_ticks[-1]) / np.abs(at_ticks).max())
    give = float(servo_compliance(run)[index, index] * law_in(run.config).stiffness[index])
    return {
        "peak": quantity(1e3 * float(np.abs(joined).max()), "mm" if index < 3 else "mrad"),
        "error": error,
        "error_at_ticks": float(np.abs(answer - at_ticks).max() / np.abs(at_ticks).max()),
        "at_rest": at_rest,
        "give": give,
        "beyond_give": abs(at_rest - give),
    }


def kept(shorter: float) -> Callable[[Run], float]:
    """Return the stiffness that the last servo keeps, in per cent, with a period `shorter` times as long."""

    def share(run: Run) -> float:
        inertia = np.diagonal(run.model.mass_matrix(run.joints("q")[0]))
        return float((100.0 * inertia / (inertia + added_inertia(run, shorter)))[-1])

    return share


def answer(axis: str) -> Callable[[Run], FloatArray]:
    """Return the displacement along an axis in mm, or about it in mrad."""
    return lambda run: 1e3 * displacement(run)[:, AXES.index(axis)]


def analytic(axis: str) -> Callable[[Run], FloatArray]:
    """Return the closed form of the answer along an axis in mm, or about it in mrad."""
    return lambda run: 1e3 * _expected(run, run.t)[:, AXES.index(axis)]


def since_push(run: Run) -> FloatArray:
    """Return the time since the load sets in, shape (T,), in s."""
    return run.t - float(run.config["environment"]["start_time"])


def critical_response(law: Admittance, loads: FloatArray, times: FloatArray) -> FloatArray:
    """Return f / K (1 - e^(-a t) (1 + a t)) with a = B / 2M, the displacement of critically damped axes, shape (T, 6).

    The constant loads f set in at rest at t = 0; in m and rad.
    """
    at = times[:, None] * law.damping / (2.0 * law.mass)
    return np.asarray(loads / law.stiffness * (1.0 - np.exp(-at) * (1.0 + at)))


def _expected(run: Run, times: FloatArray) -> FloatArray:
    since = np.maximum(times - float(run.config["environment"]["start_time"]), 0.0)
    return critical_response(law_in(run.config), loads_of(run), since)
