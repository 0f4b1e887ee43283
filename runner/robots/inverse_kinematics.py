"""Joint positions for a tip position, on the branch that holds the home posture."""

import numpy as np

from runner.errors import ConfigError
from runner.robots.model import FloatArray, RobotModel

TOLERANCE = 1e-12  # m; Newton's last step squares it, so that an arm starts at its trajectory's start to rounding
_STEPS = 200  # way-points from home to the target; each needs a few Newton steps
_MAX_NEWTON = 60


def solve_tip_position(model: RobotModel, target: FloatArray, home: FloatArray) -> FloatArray:
    """Return joint positions that bring the tip to a target, on the branch of the home posture.

    The tip is led from home to the target by Newton steps from way-point to way-point: along the straight line, or,
    where that passes a singular posture and leaves the branch, around the shoulder. A branch is known by the sign of
    det J, which only a singular posture changes.

    Args:
        model: The robot.
        target: Tip position in the base frame, shape (3,), in m.
        home: Joint positions at home, shape (nq,), in rad.

    Returns:
        Joint positions, shape (nq,), in rad; `home` itself when the target is the home tip.

    Raises:
        ConfigError: if no joint positions are found; gives the distance that is left.
    """
    start = model.tip_position(np.asarray(home, dtype=float))
    if np.array_equal(start, target):
        return np.array(home, dtype=float)
    found = [_follow(model, path, home) for path in (_straight(start, target), _around(model.shoulder, start, target))]
    missing = [float(np.linalg.norm(model.tip_position(q) - target)) for q in found]
    reached = [q for q, distance in zip(found, missing, strict=True) if distance <= 1e-9]
    if not reached:
        raise ConfigError(
            [
                f"trajectory.start: no posture brings the tip to {np.round(target, 6).tolist()} m; "
                f"{min(missing):.3g} m are left (reach {model.reach:.4g} m). Choose another start"
            ]
        )
    return next((q for q in reached if _branch(model, q) == _branch(model, home)), reached[0])


def _branch(model: RobotModel, q: FloatArray) -> float:
    """Return the sign of det J; zero for an arm whose Jacobian of the tip position is not square."""
    J = model.tip_jacobian(q)[:3]
    return float(np.sign(np.linalg.det(J))) if J.shape == (3, 3) else 0.0


def _follow(model: RobotModel, path: FloatArray, home: FloatArray) -> FloatArray:
    q = np.array(home, dtype=float)
    for point in path:
        q = _newton(model, point, q)
    return q


def _straight(start: FloatArray, target: FloatArray) -> FloatArray:
    """Return way-points on a straight line, shape (N, 3)."""
    share = np.linspace(0.0, 1.0, _STEPS + 1)[1:, None]
    points: FloatArray = (1.0 - share) * start + share * target
    points[-1] = target
    return points


def _around(centre: FloatArray, start: FloatArray, target: FloatArray) -> FloatArray:
    """Return way-points straight in radius and direction about a centre, shape (N, 3)."""
    straight = _straight(start, target) - centre
    share = np.linspace(0.0, 1.0, _STEPS + 1)[1:]
    radius = (1.0 - share) * np.linalg.norm(start - centre) + share * np.linalg.norm(target - centre)
    norm = np.linalg.norm(straight, axis=1)
    points: FloatArray = centre + straight * (radius / np.maximum(norm, 1e-6 * np.maximum(radius, 1e-12)))[:, None]
    points[-1] = target
    return points


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
