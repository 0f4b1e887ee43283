"""Springs, dampers and motors of flexible joints."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.vibration import largest_rate


@dataclass(frozen=True)
class Flexibility:
    """Springs, dampers and motors of the joints of an arm.

    Attributes:
        stiffness: K of each joint, shape (nq,), in N m/rad; infinite for a rigid joint.
        motors: B, inertia of each motor after its gear, shape (nq,), in kg m^2; 0 for a rigid joint.
        damping: D of each joint, shape (nq,), in N m s/rad; 0 for a rigid joint.
        brake_time: Time at which the brake of each motor closes, shape (nq,), in s; infinite if it stays open.
        torsion_feedback: K_f of each joint, shape (nq,), in N m s/rad: gain of the drive's motor torque against the
            rate of the spring's torsion.
    """

    stiffness: FloatArray
    motors: FloatArray
    damping: FloatArray
    brake_time: FloatArray
    torsion_feedback: FloatArray

    @property
    def flexible(self) -> np.ndarray:
        """True for each joint with a spring, shape (nq,)."""
        return np.isfinite(self.stiffness)

    def deflection(self, load: FloatArray) -> FloatArray:
        """Return theta - q at rest under torques of the links, shapes (nq,), in rad and N m."""
        return load / self.stiffness

    def largest_rate(self, M: FloatArray) -> float:
        r"""Return the largest magnitude of an eigenvalue of the arm about a configuration, in 1/s, without gravity.

        .. math:: \begin{bmatrix} M & \\ & B \end{bmatrix} \ddot x +
            \begin{bmatrix} D & -D \\ -D & D \end{bmatrix} \dot x +
            \begin{bmatrix} K & -K \\ -K & K \end{bmatrix} x = 0, \qquad x = (q, \theta)

        Args:
            M: Mass matrix of the links in that configuration, shape (nq, nq), in kg m^2.
        """
        on, nq = self.flexible, len(M)
        picks = np.hstack([np.eye(nq)[on], -np.eye(int(on.sum()))])  # deflections from (q, theta of flexible joints)
        inertia = np.diag(np.concatenate([np.zeros(nq), self.motors[on]]))
        inertia[:nq, :nq] = M
        K = picks.T @ np.diag(self.stiffness[on]) @ picks
        D = picks.T @ np.diag(self.damping[on]) @ picks
        return largest_rate(inertia, D, K)
