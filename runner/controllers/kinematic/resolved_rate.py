"""Resolved-rate control: weighted, damped and bounded joint velocities with a null-space motion."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import lapack


class ResolvedRate:
    r"""Joint velocities for a tip velocity, closest to those of a null-space task.

    .. math::

        \dot q = \dot q_0 + W^{-1} J^T (J W^{-1} J^T + \lambda^2 1)^{-1} (v - J \dot q_0)

    With lambda = 0 and W = 1 this is J^+ v + (1 - J^+ J) q0', with J^+ = J^T (J J^T)^-1 of a wide Jacobian. lambda
    grows from zero as the smallest singular value sigma of J W^-1/2 falls below a threshold, lambda^2 = damping^2
    (1 - (sigma / damping)^2) (Nakamura and Hanafusa, Journal of Dynamic Systems, Measurement and Control 108, 1986).

    Joints that would leave their bounds are fixed at them, the worst first, and the others are solved again (saturation
    in the null space: Flacco, De Luca and Khatib, IEEE Transactions on Robotics 31(3), 2015). If the others cannot
    compensate, the velocities are clipped and v is not reached.

    Args:
        weights: Diagonal of W, shape (nq,): cost of the motion of each joint.
        damping: Threshold of the singular value, and largest lambda, in the unit of J; 0 for no damping.
    """

    def __init__(self, weights: FloatArray, damping: float) -> None:
        self._mobility = 1.0 / weights
        self._damping = damping

    def solve(self, J: FloatArray, v: FloatArray, dq0: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
        """Return joint velocities within their bounds, shape (nq,), in rad/s.

        Args:
            J: Jacobian of the tip's task, shape (m, nq).
            v: Velocity of the tip's task, shape (m,).
            dq0: Joint velocities of the null-space task, shape (nq,), in rad/s.
            lower: Smallest joint velocities, shape (nq,), in rad/s.
            upper: Largest joint velocities, shape (nq,), in rad/s.

        Raises:
            numpy.linalg.LinAlgError: at a singular configuration, without damping.
        """
        dq = self._solve(J, v, dq0)
        beyond = np.maximum(lower - dq, dq - upper)
        if beyond.max() <= 0.0:
            return dq
        free = np.ones(len(dq), dtype=bool)
        while beyond.max() > 0.0 and free.sum() > len(v):
            worst = int(np.argmax(beyond))
            free[worst] = False
            dq[worst] = min(max(dq[worst], lower[worst]), upper[worst])
            left = v - J[:, ~free] @ dq[~free]
            try:
                dq[free] = self._solve(J[:, free], left, dq0[free], self._mobility[free])
            except np.linalg.LinAlgError:
                break  # the others are singular
            beyond = np.where(free, np.maximum(lower - dq, dq - upper), 0.0)
        return np.minimum(np.maximum(dq, lower), upper)

    def _solve(self, J: FloatArray, v: FloatArray, dq0: FloatArray, mobility: FloatArray | None = None) -> FloatArray:
        spread = (self._mobility if mobility is None else mobility)[:, None] * J.T
        A = J.dot(spread)
        if self._damping and self._is_near(A):
            smallest = max(float(np.linalg.eigvalsh(A)[0]), 0.0)
            A.flat[:: len(A) + 1] += max(self._damping**2 - smallest, 0.0)  # the diagonal
        _, _, solution, singular = lapack.dgesv(A, v - J.dot(dq0))
        if singular:
            raise np.linalg.LinAlgError("the tip's Jacobian is singular")
        return np.asarray(dq0 + spread.dot(solution))

    def _is_near(self, A: FloatArray) -> bool:
        """Return True if an eigenvalue of A is below damping^2; a Cholesky factorisation shows it faster."""
        above = A.copy()
        above.flat[:: len(A) + 1] -= self._damping**2
        return bool(lapack.dpotrf(above)[1] != 0)
