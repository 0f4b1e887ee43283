"""Joint positions for a tip position, on the branch that holds the home posture."""

import numpy as np

from runner.errors import ConfigError
from runner.robots.model import FloatArray, RobotModel

TOLERANCE = 1e-12  # m; Newton's last step squares it, so that an arm starts at its trajectory's start to rounding
_STEPS = 200  # way-points from home to the target; each needs a few Newton steps
_MAX_NEWTON = 60


def solve_tip_position(model: RobotModel, target: FloatArray, home: FloatArray) -> FloatArray:
    """Return joint positions that bring the tip to a target, followed continuously from home.

    The tip is led from home to the target along the shortest curve that keeps its distance to the shoulder between
    the two ends' (straight in radius and direction), with Newton steps at each way-point; so the arm stays on the
    branch (elbow side) of its home posture.

    Args:
        model: The robot.
        target: Tip position in the base frame, shape (3,), in m.
        home: Joint positions at home, shape (nq,), in rad.

    Returns:
        Joint positions, shape (nq,), in rad; `home` itself when the target is the home tip.

    Raises:
        ConfigError: if no joint positions are found; gives the distance that is left.
    """
    q = np.array(home, dtype=float)
    start = model.tip_position(q)
    if np.array_equal(start, target):
        return q
    for share in np.linspace(0.0, 1.0, _STEPS + 1)[1:]:
        q = _newton(model, _between(start - model.shoulder, target - model.shoulder, share) + model.shoulder, q)
    missing = float(np.linalg.norm(model.tip_position(q) - target))
    if missing > 1e-9:
        raise ConfigError(
            [
                f"trajectory.start: no posture on the home branch brings the tip to {np.round(target, 6).tolist()} m; "
                f"{missing:.3g} m are left (reach {model.reach:.4g} m). Choose a start away from a singular posture"
            ]
        )
    return q


def _between(a: FloatArray, b: FloatArray, share: float) -> FloatArray:
    """Interpolate radius and direction, so that the way-points do not cut through the middle of the workspace."""
    straight = (1.0 - share) * a + share * b
    norm = float(np.linalg.norm(straight))
    radius = (1.0 - share) * float(np.linalg.norm(a)) + share * float(np.linalg.norm(b))
    return straight if norm < 1e-6 * max(radius, 1e-12) else straight * (radius / norm)


def _newton(model: RobotModel, target: FloatArray, q: FloatArray) -> FloatArray:
    for _ in range(_MAX_NEWTON):
        error = target - model.tip_position(q)
        if np.linalg.norm(error) < TOLERANCE:
            break
        J = model.tip_jacobian(q)[:3]
        # The damping vanishes with the error: Newton's speed near the solution, no leaps near a singular posture.
        damping = 1e-3 * float(error @ error)
        q = q + J.T @ np.linalg.solve(J @ J.T + damping * np.eye(3), error)
    return q
