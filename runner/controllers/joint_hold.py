"""Holding a posture in joint space."""

import numpy as np
import pinocchio as pin

from runner.controllers.controller import FloatArray
from runner.robots import RobotModel


class JointHold:
    r"""Inverse dynamics that holds a posture.

    .. math:: \tau = M (-\omega_n^2 (q - q_0) - 2 \xi \omega_n \dot q) + V + G

    Args:
        model: The arm, on a fixed base.
        natural_frequency: omega_n in rad/s.
        damping_ratio: xi.
        gravity_compensation: Whether G is part of the law.
    """

    def __init__(
        self, model: RobotModel, natural_frequency: float, damping_ratio: float, gravity_compensation: bool
    ) -> None:
        self._model = pin.Model(model.pin_model)
        self._data = self._model.createData()
        self._k_p = natural_frequency**2
        self._k_v = 2.0 * damping_ratio * natural_frequency
        self._gravity_compensation = gravity_compensation
        self.set_gravity(model.gravity)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector in the arm's base frame, shape (3,), in m/s^2."""
        self._model.gravity.linear = gravity if self._gravity_compensation else np.zeros(3)

    def torque(self, q: FloatArray, dq: FloatArray, posture: FloatArray) -> FloatArray:
        """Return the torques that hold a posture, shapes (nq,), in N m from rad and rad/s."""
        ddq = self._k_p * (posture - q) - self._k_v * dq
        torque: FloatArray = pin.rnea(self._model, self._data, q, dq, ddq)
        return torque
