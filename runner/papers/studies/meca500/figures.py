"""Signals, forces, admittance laws and calibration errors for the chapters of the Meca500 study."""

from functools import lru_cache
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.calibration.tool_direction import alignment, alignment_angles
from runner.controllers.force.admittance_filter import AdmittanceFilter
from runner.papers.studies.meca500.plan import law_in
from runner.papers.study.prose.signals import Quantity, turns
from runner.papers.study.results import Results
from runner.robots.model import RobotModel
from runner.store import Calibration, Run

Calibrations = Results[Any]  # of Calibration
once = lru_cache(maxsize=256)  # of functions of a run, which several chapters call
_STILL = 1e-4  # N, below which a force that swings is rounding
_HELD = " has held the tool back"


def wrenches(run: Run, signal: str) -> FloatArray:
    """Return a signal such as "felt" at each tick, force in N and moment in N m, shape (T, 6)."""
    return np.hstack([run.vector(f"{signal}_{kind}") for kind in ("force", "moment")])


@once
def displacement(run: Run) -> FloatArray:
    """Return the tip's translation and rotation since the first row, shape (T, 6), in m and rad."""
    tip = run.vector("tip")
    return np.hstack([tip - tip[0], turns(run)])


def loads_of(run: Run) -> FloatArray:
    """Return force and moment that push a run's tip, shape (6,), in N and N m."""
    return np.array([*run.config["environment"]["force"], *run.config["environment"]["moment"]], dtype=float)


def added_inertia(run: Run, shorter: float = 1.0) -> FloatArray:
    """Return h D + h^2 K of each servo, in kg m^2, with a period h of `shorter` times that of the run."""
    servo = run.config["plant"]["servo"]
    K, period = float(servo["stiffness"]), shorter * float(servo["period"])
    inertia = np.diagonal(run.model.mass_matrix(np.array(run.config["robot"]["home"])))
    return np.asarray(2.0 * period * float(servo["damping_ratio"]) * np.sqrt(K * inertia) + period**2 * K)


def servo_compliance(run: Run) -> FloatArray:
    r"""Return the tip's displacement at rest per unit of load, along and about the base's axes, shape (6, 6).

    The servos evaluate spring and damper with the acceleration that they would bring an unloaded arm. A load that holds
    the arm still stops that acceleration, and at the first posture of a run there is left

    .. math:: K_e = M (M + h D + h^2 K)^{-1} K, \qquad C = J K_e^{-1} J^T

    It is zero on the kinematic plant, whose joints have no servos.
    """
    if run.config["plant"]["kind"] == "kinematic":
        return np.zeros((6, 6))
    model, q = run.model, run.joints("q")[0]
    M, J = model.mass_matrix(q), model.tip_jacobian(q)
    kept = M @ np.linalg.inv(M + np.diag(added_inertia(run))) * float(run.config["plant"]["servo"]["stiffness"])
    return J @ np.linalg.solve(kept, J.T)


def bounces(run: Run) -> bool:
    """Return True if contact is observed to be unstable.

    It is unstable if in the last third of a run the tip leaves the wall, or if the force swings more widely than in
    the third before.
    """
    force = -wrenches(run, "external")[:, 0]
    third = len(force) // 3
    before, last = force[third : 2 * third], force[-third:]
    return bool(last.min() <= 0.0 or np.ptp(last) > max(np.ptp(before), _STILL))


def degrees(angle: float) -> float:
    """Return an angle in rad in degrees."""
    return float(np.degrees(angle))


def flange_of(calibration: Calibration) -> RobotModel:
    """Return the arm that was calibrated, with its flange as tip."""
    return RobotModel(calibration.urdf, calibration.provenance["flange"], calibration.config["gravity"])


def error(*names: str) -> Quantity:
    """Return the root mean square over the repetitions of the length of an error, of named components or of all."""
    return Quantity(lambda done: np.sqrt(np.mean(np.sum(done.values("errors", *names) ** 2, axis=1))))


def predicted(*names: str) -> Quantity:
    """Return the standard deviation of `error` by the covariances."""
    return Quantity(lambda done: np.sqrt(np.mean(np.sum(done.values("deviations", *names) ** 2, axis=1))))


def largest_error(done: Calibration) -> float:
    """Return the largest error of all repetitions."""
    return float(np.abs(done.values("errors")).max())


def filtered_turn(run: Run) -> float:
    """Return the largest rotation that the law makes of the wrenches felt in a run, in rad."""
    law = AdmittanceFilter(law_in(run.config), float(run.config["controller"]["period"]))
    largest = 0.0
    for wrench in wrenches(run, "felt"):
        law.step(wrench)
        largest = max(largest, float(np.linalg.norm(law.displacement[3:])))
    return largest


def as_felt(run: Run) -> FloatArray:
    """Return the wall's push as felt, shape (T,), in N; what is felt is the reading of a tick before."""
    return np.append(-wrenches(run, "felt")[1:, 0], np.nan)


def compliance_along_x(run: Run) -> float:
    """Return the tip's displacement at rest along x per unit of force along x by the servos' springs, in m/N."""
    return float(servo_compliance(run)[0, 0])


def speed_shares(run: Run) -> FloatArray:
    """Return the speed of each joint at each row over its limit, shape (T, nq)."""
    return run.joints("dq") / run.model.velocity_limits


def speed_changes(run: Run) -> FloatArray:
    """Return the changes of these shares from tick to tick, shape (T - 1, nq)."""
    return np.diff(speed_shares(run), axis=0)


def singular_share(run: Run) -> float:
    """Return the smallest singular value of the tip's Jacobian over that at the start, at every tenth row."""
    values = [np.linalg.svd(run.model.tip_jacobian(q), compute_uv=False)[-1] for q in run.joints("q")[::10]]
    return float(min(values) / values[0])


def stopped(run: Run) -> bool:
    """Return True if a run's warnings name the limit that stopped the tool."""
    return any(_HELD in text for text in run.provenance["warnings"])


def stopped_by(run: Run) -> str:
    """Return a run's warnings as a cell of a table."""
    said = "; ".join(run.provenance["warnings"]).replace(f"{_HELD}, first at t =", " from")
    return said.replace("the posture, singular or nearly so", "a posture at or near a singularity")


def misread(done: Calibration) -> dict[str, float]:
    """Return the angles between the tool and its direction by equation 7, as `printed` and as `described`, in °."""
    t = np.array(done.config["calibration"]["direction"])
    t /= np.linalg.norm(t)
    R = alignment(*alignment_angles(t))
    return {name: degrees(np.arccos(np.clip(along @ t, -1.0, 1.0))) for name, along in
            (("printed", R[2]), ("described", R[:, 2]))}  # fmt: skip
