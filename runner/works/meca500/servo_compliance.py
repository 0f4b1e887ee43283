"""How far joint servos give way to a load that they do not know of."""

import numpy as np

from runner.reporting.document import FloatArray
from runner.reporting.figures import joint_columns, model_of
from runner.store import Run


def servo_compliance(run: Run) -> FloatArray:
    r"""Return the tip's displacement at rest per unit of load, along and about the base's axes, shape (6, 6).

    The servo evaluates spring and damper at the end of its period h, with the acceleration that they would bring an
    unloaded arm (see JointServo). A load that holds the arm still stops that acceleration, and of the spring K is left

    .. math:: K_e = M (M + h D + h^2 K)^{-1} K, \qquad C = J K_e^{-1} J^T

    Args:
        run: A run on joint servos; its first posture is taken.
    """
    servo = run.config["plant"]["servo"]
    model, q = model_of(run), joint_columns(run.trace, "q")[0]
    K = float(servo["stiffness"])
    M, J = model.mass_matrix(q), model.tip_jacobian(q)
    added = np.diag(_added(run, float(servo["period"])))
    compliance: FloatArray = J @ np.linalg.solve(M @ np.linalg.inv(M + added) * K, J.T)
    return compliance


def kept_stiffness(run: Run, period: float) -> FloatArray:
    """Return the share of its stiffness that each servo keeps against a load on its joint alone, shape (nq,).

    Args:
        run: A run on joint servos; its first posture is taken.
        period: Of the servos, in s.
    """
    inertia = np.diagonal(model_of(run).mass_matrix(joint_columns(run.trace, "q")[0]))
    kept: FloatArray = inertia / (inertia + _added(run, period))
    return kept


def _added(run: Run, period: float) -> FloatArray:
    """Return h D + h^2 K of each servo, in kg m^2."""
    servo = run.config["plant"]["servo"]
    K = float(servo["stiffness"])
    inertia = np.diagonal(model_of(run).mass_matrix(np.array(run.config["robot"]["home"])))
    added: FloatArray = 2.0 * period * float(servo["damping_ratio"]) * np.sqrt(K * inertia) + period**2 * K
    return added
