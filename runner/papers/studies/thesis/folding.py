"""Folding of the Mini: distance to a singular configuration, stabilizing sag, and time at which two draws part.

The folded Mini is chaotic: the result of a single run depends on rounding; the common result of all repetitions does
not.
"""

import numpy as np
import pinocchio as pin

from runner.papers.study.prose.signals import difference, norm, of_joints
from runner.store import Run

_PARTED = 1.0  # rad


def sag(run: Run) -> float:
    """Return the closed form of the Macro's sag at the end of a run, in m."""
    rate = float(run.config["controller"]["natural_frequency"]["macro"])
    return missing_acceleration(run, len(run.t) - 1) / rate**2


def parted_at(first: Run, second: Run) -> float | None:
    """Return from when on two runs have been 1 rad apart, in s; None where they never are."""
    apart = norm(difference(of_joints()))(first, second) >= _PARTED
    return float(first.t[int(apart.argmax())]) if apart.any() else None


def missing_acceleration(run: Run, row: int) -> float:
    """Return the acceleration of the Macro's end point by the gravity that its law leaves out, in m/s^2."""
    whole = run.model
    q = run.joints("q")[row]
    base = whole.pin_model.getFrameId(run.provenance["stages"]["mini"])
    data = whole.pin_model.createData()
    J = pin.computeFrameJacobian(whole.pin_model, data, q, base, pin.LOCAL_WORLD_ALIGNED)[:3, :3]
    macro, known = _macro_alone(run, 0.0), _macro_alone(run, _known_payload(run))
    M = np.triu(pin.crba(known, known.createData(), q))[:3, :3]
    M += np.triu(M, 1).T
    true = whole.pin_model if run.config["plant"]["dynamics"] == "coupled" else macro
    G = pin.computeGeneralizedGravity(true, true.createData(), q)[:3]
    if run.config["controller"]["gravity_compensation"]:
        G = G - pin.computeGeneralizedGravity(known, known.createData(), q)[:3]
    return float(np.linalg.norm(J @ np.linalg.solve(M, G)))


def _known_payload(run: Run) -> float:
    """Return the mass of the Mini that the Macro's model knows, in kg."""
    if run.config["controller"]["payload"] != "known":
        return 0.0
    return float(sum(inertia.mass for inertia in list(run.model.pin_model.inertias)[4:]))


def _macro_alone(run: Run, payload: float) -> pin.Model:
    """Return the arm with a Mini without mass, and a point mass at the Macro's end point."""
    model = pin.Model(run.model.pin_model)
    for joint in range(4, model.njoints):
        model.inertias[joint] = pin.Inertia.Zero()
    frame = model.frames[model.getFrameId(run.provenance["stages"]["mini"])]
    model.appendBodyToJoint(3, pin.Inertia(payload, np.zeros(3), np.zeros((3, 3))), frame.placement)
    return model
