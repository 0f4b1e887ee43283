"""Payload capacity of the joints, from their effort limits."""

import numpy as np
from scipy.optimize import brute, minimize

from runner.base.arrays import FloatArray
from runner.papers.studies.xarm7.figures import SHOULDER
from runner.papers.study.results import Runs, matching_runs
from runner.reporting.document import Series
from runner.store import Run

_PLANE = [1, 3, 5]  # the joints in the arm's vertical plane
_GRID = 12  # angles of each, where the search for the widest posture begins


def largest_payloads(torque: FloatArray, per_kilogram: FloatArray, limits: FloatArray) -> FloatArray:
    """Return the payload at which each joint reaches its limit first, shape (nq,), in kg; inf where it never does.

    Torques without payload and what each kilogram adds have shape (..., nq).
    """
    room = limits - np.sign(per_kilogram) * torque
    slope = np.abs(per_kilogram)
    masses = np.divide(room, slope, out=np.full(slope.shape, np.inf), where=slope > 1e-9)
    return np.asarray(masses.reshape(-1, masses.shape[-1]).min(axis=0))


def stretched(run: Run) -> tuple[float, FloatArray]:
    """Return the flange's distance from the first axis with the arm stretched out level, and each joint's payload.

    The distance is in m; the payload with which a joint's static torque is its limit in kg, shape (nq,), inf for none.
    """
    model = run.model
    lower, upper = model.position_limits[:, _PLANE]

    def posture(angles: FloatArray) -> FloatArray:
        q = np.zeros(model.nq)
        q[_PLANE] = angles
        return q

    def behind(angles: FloatArray) -> float:
        return float(-model.tip_position(posture(angles))[0])

    bounds = tuple(zip(lower, upper, strict=True))
    found = minimize(
        behind,
        x0=brute(behind, bounds, Ns=_GRID, finish=None),
        jac=lambda angles: -model.tip_jacobian(posture(angles))[0, _PLANE],
        bounds=bounds,
        options={"ftol": 1e-15, "gtol": 1e-12},
    )
    q = posture(found.x)
    unloaded = model.gravity_torque(q)
    added = model.with_payload(1.0).gravity_torque(q) - unloaded
    return -float(found.fun), largest_payloads(unloaded, added, model.effort_limits)


def along_the_line(runs: Runs, group: str) -> FloatArray:
    """Return the payload with which each joint meets its effort limit along a line, shape (nq,), in kg; see asked."""
    light, torque, added = _torques(runs, group)
    return largest_payloads(torque, added, light.model.effort_limits)


def others(payloads: FloatArray) -> float:
    """Return with which payload the first of the joints other than the shoulder meets its limit, in kg."""
    return float(np.delete(payloads, SHOULDER).min())


def limit_rows(runs: Runs, run: str, *payloads: FloatArray) -> list[list[str | float]]:
    """Return the effort limit of each joint of a run's arm and payloads with which it is met: a row for each."""
    return [
        [f"q{joint + 1}", limit, *(each[joint] for each in payloads)]
        for joint, limit in enumerate(runs[run].model.effort_limits)
    ]


def asked(runs: Runs, group: str, largest: float) -> list[Series]:
    """Return each joint's largest torque on the line over its effort limit, by the payload in kg.

    Two runs on ideal joints have names that begin so: one without payload and one with it.
    """
    light, torque, added = _torques(runs, group)
    masses = np.linspace(0.0, largest, 51)
    shares = np.array([np.abs(torque + m * added).max(axis=0) / light.model.effort_limits for m in masses])
    return [Series(f"q{joint + 1}", masses, share) for joint, share in enumerate(shares.T)]


def _torques(runs: Runs, group: str) -> tuple[Run, FloatArray, FloatArray]:
    """Return the run without payload, the torques asked of it, and what each kilogram adds, shapes (T, nq)."""
    light, heavy = (one.run for one in matching_runs(runs, f"{group}/{{mass}}"))
    unloaded, loaded = (run.joints("tau") for run in (light, heavy))
    rows = min(len(unloaded), len(loaded))
    kilograms = heavy.config["robot"]["payload"]["mass"] - light.config["robot"]["payload"]["mass"]
    return light, unloaded[:rows], (loaded[:rows] - unloaded[:rows]) / kilograms


def lost_when(run: Run) -> str:
    """Return when an axis error of the tip leaves the settling band for the first time, in s, as a cell of a table."""
    beyond = (np.abs(run.vector("error")) > run.config["robot"]["settling_band"]).any(axis=1)
    return f"{run.t[int(np.argmax(beyond))]:.3g}" if beyond.any() else "not lost"
