"""Workspace of an arm: reachable tip positions and manipulability (thesis section 2.3)."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel

_REFINED = 5  # samples from which the nearest extremum is searched
_MOST_STEPS = 500
_SMALLEST_MOVE = 1e-10  # rad or m: the search has converged


@dataclass(frozen=True)
class Workspace:
    """Results of a workspace analysis.

    Attributes:
        tips: Sampled tip positions in the base frame, shape (N, 3), in m.
        manipulability: Manipulability at each sample, shape (N,), in m^3.
        shoulder: Origin of joint 1 in the base frame, from which distances are measured, shape (3,), in m.
        outer: Largest distance of the tip from the shoulder, in m.
        inner: Smallest distance of the tip from the shoulder, in m.
        reach: Sum of the link lengths, which is the outer radius of an arm that can be stretched out, in m.
    """

    tips: FloatArray
    manipulability: FloatArray
    shoulder: FloatArray
    outer: float
    inner: float
    reach: float


def manipulability(jacobians: FloatArray) -> FloatArray:
    """Return the product of the singular values of linear Jacobians, shape (N, 3, nq) to (N,).

    It is |det J_v| for three joints and sqrt(det J_v J_v^T) in general: the volume, in m^3, that the tip velocity spans
    per unit of joint velocity. It is zero in a singular configuration.
    """
    product: FloatArray = np.prod(np.linalg.svd(jacobians, compute_uv=False), axis=-1)
    return product


def analyse(model: RobotModel, samples: int, generator: np.random.Generator) -> Workspace:
    """Sample the workspace of an arm and find its largest and smallest radius.

    The thesis gives a sphere of radius 2 m (Macro, figure 2.3) and 0.2 m (Mini, figure 2.4), which is the outer
    radius. It does not mention the positions in which the tip cannot move in every direction. For both of its arms

        det J_v = -L^3 c3 (c2 - s23),

    which vanishes on the surface of the sphere (arm stretched, q3 = -90 deg), at the shoulder (folded, q3 = 90 deg) and
    on the whole axis of joint 1 inside the sphere (c2 = s23). Its magnitude depends on the tip position only: it is
    L r rho sqrt(1 - (rho / 2L)^2), with the distances r from the axis and rho from the shoulder. So one picture is
    valid for both elbow branches.

    Args:
        model: The robot.
        samples: Number of random joint positions, uniform within the joint limits and one turn.
        generator: Random generator.
    """
    lower, upper = model.usual_range
    q = generator.uniform(lower, upper, (samples, model.nq))
    tips = model.tip_positions(q)
    jacobians = np.array([model.tip_jacobian(configuration)[:3] for configuration in q])
    order = np.argsort(np.linalg.norm(tips - model.shoulder, axis=1))
    return Workspace(
        tips=tips,
        manipulability=manipulability(jacobians),
        shoulder=model.shoulder,
        outer=max(_extreme_distance(model, start, -1.0) for start in q[order[-_REFINED:]]),
        inner=min(_extreme_distance(model, start, 1.0) for start in q[order[:_REFINED]]),
        reach=model.reach,
    )


def _extreme_distance(model: RobotModel, start: FloatArray, sign: float) -> float:
    """Return the distance of the tip from the shoulder at the nearest minimum (sign 1) or maximum (sign -1).

    The search is a projected gradient descent with the step length of Barzilai and Borwein (1988), which is as fast
    here as a quasi-Newton method, without the import of scipy.optimize.
    """
    lower, upper = model.pin_model.lowerPositionLimit, model.pin_model.upperPositionLimit
    q, best = start.copy(), np.inf
    arm = model.tip_position(q) - model.shoulder
    slope = sign * model.tip_jacobian(q)[:3].T @ arm
    step = 1.0 / max(model.reach, 1e-12) ** 2
    for _ in range(_MOST_STEPS):
        best = min(best, sign * float(np.linalg.norm(arm)))
        moved = np.clip(q - step * slope, lower, upper) - q
        if np.abs(moved).max() < _SMALLEST_MOVE:
            break
        q = q + moved
        arm = model.tip_position(q) - model.shoulder
        before, slope = slope, sign * model.tip_jacobian(q)[:3].T @ arm
        bend = float(moved @ (slope - before))
        step = float(moved @ moved) / bend if bend > 0.0 else 2.0 * step
    return sign * best
