"""Folding of the Mini: distance to a singular configuration, stabilizing sag, and scatter over repetitions.

The folded Mini is chaotic: the result of a single run depends on rounding; the common result of all repetitions does
not.
"""

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.base.quantities import format_range, number, quantity
from runner.store import Run
from runner.studies.thesis.figures import at_rest
from runner.study.measured import ROUNDING

_PARTED = 1.0  # rad


def singular_value(run: Run) -> FloatArray:
    """Return the smallest singular value of the Mini's Jacobian at each tick, shape (T,), in m."""
    return _singular_values(run)[:, -1]


def volume(run: Run) -> FloatArray:
    """Return the manipulability |det J| of the Mini at each tick, shape (T,), in m^3."""
    return np.asarray(_singular_values(run).prod(axis=1))


def closest(signal: Callable[[Run], FloatArray]) -> Callable[[Run], float]:
    """Return the value of a signal where the Mini is closest to a singular posture."""
    return lambda run: float(signal(run)[_row(run)])


def volume_of_closest(run: Run) -> str:
    """Return the manipulability there for a table: folded, it is smaller than what is called rounding elsewhere."""
    return number(closest(volume)(run))


def time_of_closest(run: Run) -> str:
    """Return when that is, in s."""
    return f"{run.t[_row(run)]:.2f}"


def sag(run: Run) -> float:
    """Return the closed form of the Macro's sag at the end of a run, in m."""
    rate = float(run.config["controller"]["natural_frequency"]["macro"])
    return missing_acceleration(run, len(run.trace()) - 1) / rate**2


def farthest_at_rest(run: Run) -> float | None:
    """Return the largest steady-state error of the repetitions that do not diverge, in m; None where all do."""
    return max(at_rest(run), default=None)


def spread_at_rest(run: Run) -> float | None:
    """Return by how much the steady-state errors of those repetitions differ, in m; None where all diverge."""
    errors = at_rest(run)
    return max(errors) - min(errors) if errors else None


def at_rest_text(run: Run) -> str:
    """Return the range of the steady-state errors of those repetitions for a table; one number where they are alike."""
    errors = at_rest(run)
    if not errors:
        return "failed"
    low, high = min(errors), max(errors)
    return format_range(low, high, "m") if high - low > ROUNDING else quantity(high, "m", rounding=ROUNDING)


def parting(first: Run, second: Run) -> FloatArray:
    """Return the distance between the joint positions of two runs at their common ticks, shape (T,), in rad."""
    a, b = (run.joints("q") for run in (first, second))
    rows = min(len(a), len(b))
    return np.asarray(np.linalg.norm(a[:rows] - b[:rows], axis=1))


def parted_at(first: Run, second: Run) -> float | None:
    """Return from when on two runs have been 1 rad apart, in s; None where they never are."""
    apart = parting(first, second) >= _PARTED
    return float(first.t[int(apart.argmax())]) if apart.any() else None


def _row(run: Run) -> int:
    singular = singular_value(run)
    return int(np.nanargmin(singular)) if np.isfinite(singular).any() else 0


def _singular_values(run: Run) -> FloatArray:
    """Return those of the Mini's columns of the whole arm's Jacobian, shape (T, 3): they depend on no frame."""
    model, positions = run.model, run.joints("q")
    values, finite = np.full((len(positions), 3), np.nan), np.isfinite(positions).all(axis=1)
    jacobians = [model.tip_jacobian(q)[:3, 3:] for q in positions[finite]]
    values[finite] = np.linalg.svd(np.reshape(jacobians, (-1, 3, 3)), compute_uv=False)
    return values


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
