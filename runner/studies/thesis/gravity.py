"""Steady-state sag of a controller without gravity compensation."""

import numpy as np

from runner.reporting.figures import joint_columns, model_of
from runner.store import Run


def sag(run: Run) -> float:
    """Return |J M^-1 G| / omega_n^2 at the run's final true joint positions, in m."""
    model = model_of(run)
    q = joint_columns(run.trace, "q")[-1]
    fall = model.tip_jacobian(q)[:3] @ np.linalg.solve(model.mass_matrix(q), model.gravity_torque(q))
    return float(np.linalg.norm(fall / run.config["controller"]["natural_frequency"] ** 2))
