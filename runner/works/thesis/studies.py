"""What the studies of the combined arm share: cells of their tables, and measures of the arm's shape."""

import numpy as np
import pinocchio as pin

from runner.reporting.document import FloatArray
from runner.reporting.figures import columns, joint_columns, model_of
from runner.reporting.quantities import number
from runner.reporting.run_values import cell, median
from runner.store import Run


def settled(run: Run) -> str:
    """Return the settling time for a table; "never" where the tip has not settled."""
    if run.status == "failed":
        return "failed"
    return "never" if median(run, "settling_time") is None else cell(run, "settling_time")


def ratio(large: float | None, small: float | None) -> str:
    """Return how many times one number is another; a dash where one is missing or zero."""
    return number(large / small, 2) if large is not None and small else "–"


def largest(values: FloatArray) -> float | None:
    """Return the largest finite value, or None."""
    finite = values[np.isfinite(values)]
    return float(finite.max()) if finite.size else None


def rest_of_way(run: Run) -> FloatArray:
    """Return |x_d - x_E|, from the Macro's end point to the target, shape (T,), in m."""
    distance: FloatArray = np.linalg.norm(columns(run.trace, "desired") - columns(run.trace, "macro_tip"), axis=1)
    return distance


def extension(run: Run) -> FloatArray:
    """Return |p|, from the Macro's end point to the tip, shape (T,), in m."""
    distance: FloatArray = np.linalg.norm(columns(run.trace, "tip") - columns(run.trace, "macro_tip"), axis=1)
    return distance


def mini_dexterity(run: Run) -> FloatArray:
    """Return smallest singular value (m) and manipulability |det J| (m^3) of the Mini at each tick, shape (T, 2).

    They do not depend on the frame, so the Mini's columns of the whole arm's Jacobian serve.
    """
    model = model_of(run)
    measures = np.full((len(run.trace), 2), np.nan)
    for row, q in zip(measures, joint_columns(run.trace, "q"), strict=True):
        if np.isfinite(q).all():
            singular = np.linalg.svd(model.tip_jacobian(q)[:3, 3:], compute_uv=False)
            row[:] = singular[-1], singular.prod()
    return measures


def wrist_rotations(run: Run) -> FloatArray:
    """Return the true rotation from the Mini's base frame into the robot's at each tick, shape (T, 3, 3)."""
    model = model_of(run)
    base = model.pin_model.getFrameId(run.provenance["stages"]["mini"])
    data = model.pin_model.createData()
    rotations = np.full((len(run.trace), 3, 3), np.nan)
    for row, q in zip(rotations, joint_columns(run.trace, "q"), strict=True):
        if np.isfinite(q).all():
            pin.forwardKinematics(model.pin_model, data, q)
            row[:] = pin.updateFramePlacement(model.pin_model, data, base).rotation
    return rotations
