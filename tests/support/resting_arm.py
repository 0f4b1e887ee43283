"""Stable gains of a sampled law on an arm with only flexible joints, by the map of one period about rest."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from runner.base.arrays import FloatArray


@dataclass(frozen=True)
class RestingArm:
    """An arm with flexible joints about a configuration at rest.

    Attributes:
        M: Mass matrix of the links, shape (nq, nq), in kg m^2.
        W: Slope of the weight's torques, dG/dq, shape (nq, nq), in N m/rad; zeros without gravity.
        K: Stiffness of the springs, shape (nq,), in N m/rad.
        B: Inertia of the motors after their gears, shape (nq,), in kg m^2.
        D: Damping of the springs, shape (nq,), in N m s/rad.
    """

    M: FloatArray
    W: FloatArray
    K: FloatArray
    B: FloatArray
    D: FloatArray

    def radius(self, omega: float, xi: float, period: float, at_motors: bool) -> float:
        r"""Return the growth of a small motion in one period under a law for rigid joints; stable below 1.

        With x = (q, theta) about rest, Spong's model is linear, and the torque holds for a period. It follows the
        readings y at its start, which are theta or q as they are:

        .. math:: \tau = -(M + \mathrm{diag}\,B) (\omega_n^2 y + 2 \xi \omega_n \dot y) + W y

        The map is exact, by the exponential of the model with the held torque as a state.

        Args:
            omega: omega_n, in rad/s.
            xi: Damping ratio of the law.
            period: Time between two torques, in s.
            at_motors: True if y is theta, else y is q.
        """
        nq, n = len(self.M), 2 * len(self.M)
        inertia, zero = self.M + np.diag(self.B), np.zeros((nq, nq))
        slopes = np.zeros((2 * n + nq, 2 * n + nq))  # of positions, velocities and the torque, which holds
        slopes[:n, n : 2 * n] = np.eye(n)
        K, D, motors = np.diag(self.K), np.diag(self.D), 1.0 / self.B[:, None]
        slopes[n : n + nq, : 2 * n] = -np.linalg.solve(self.M, np.hstack([K + self.W, -K, D, -D]))
        slopes[n + nq : 2 * n] = motors * np.hstack([K, -K, D, -D, np.eye(nq)])
        gains = (self.W - omega**2 * inertia, -2.0 * xi * omega * inertia)
        law = np.hstack([part for gain in gains for part in ((zero, gain) if at_motors else (gain, zero))])
        held = expm(slopes * period)[: 2 * n]
        return float(np.abs(np.linalg.eigvals(held[:, : 2 * n] + held[:, 2 * n :] @ law)).max())
