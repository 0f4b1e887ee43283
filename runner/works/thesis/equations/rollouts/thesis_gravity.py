"""The thesis' Macro held by its gravity term, as printed and right. Lengths in m, torques in N m."""

import numpy as np

from runner.audit.rollout import Rollout
from runner.audit.truth import FloatArray
from runner.works.thesis.equations.truths.thesis_arms import MACRO

_FREQUENCY = 30.0  # rad/s, section 3.3.1
_POSTURE = (0.0, -0.4)  # rad, joints 1 and 2


def macro() -> Rollout:
    """Return how far the Macro sags with s2 in the place of s23."""
    degrees = np.linspace(-75, 75, 151)
    q = np.column_stack([np.full(len(degrees), angle) for angle in _POSTURE] + [np.radians(degrees)])
    c2, s2, s23 = np.cos(q[:, 1]), np.sin(q[:, 1]), np.sin(q[:, 1] + q[:, 2])
    printed, right = (np.column_stack([0 * c2, 19.62 * c2 - 9.81 * s, -9.81 * s]) for s in (s2, s23))
    sag = _sag(q, printed)
    return Rollout(
        "The Macro held by its gravity term",
        f"Held at rest by the thesis' goal control with a natural frequency of {_FREQUENCY:.0f} rad/s, joint 3 at many "
        f"angles. With $s_2$ for $s_23$ the tip rests up to {100 * sag.max():.1f} cm from its goal, more than the "
        "steady-state error that the thesis prints; with the right term it rests there.",
        "position of joint 3 (degrees)",
        "tip to goal (m)",
        degrees,
        {"as printed": sag, "corrected": _sag(q, right)},
    )


def _sag(q: FloatArray, compensated: FloatArray) -> FloatArray:
    """Return how far the tip rests from its goal: Lambda omega_n^2 error = J^-T (G - what is compensated)."""
    model = MACRO.model()
    distances = []
    for row, torque in zip(q, compensated, strict=True):
        missing = np.linalg.solve(model.mass_matrix(row), model.gravity_torque(row) - torque)
        distances.append(np.linalg.norm(model.tip_jacobian(row)[:3] @ missing) / _FREQUENCY**2)
    return np.array(distances)
