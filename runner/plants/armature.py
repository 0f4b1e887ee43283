"""Torque correction for joint armature, for engines without armature."""

import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.plants.compiled_motion import compile_links_torque
from runner.robots.model import RobotModel


class LinksTorque:
    r"""Torques that give links without armature the accelerations of an arm with it.

    .. math:: \tau' = \tau - A \ddot q, \qquad (M + A) \ddot q + h = \tau
        \quad\Rightarrow\quad M \ddot q + h = \tau'

    h is the bias and gravity torque. It is exact in free motion, in each state for itself. Accelerations are compiled
    code's where that is to be had, else those of Pinocchio's articulated-body algorithm.

    Args:
        model: The arm, with its armature A.
    """

    def __init__(self, model: RobotModel) -> None:
        self._compiled = compile_links_torque(model)
        self._model = pin.Model(model.pin_model)
        self._data, self._armature = self._model.createData(), model.armature

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector in the base frame, shape (3,), in m/s^2."""
        self._model.gravity.linear = gravity
        if self._compiled is not None:
            self._compiled.set_gravity(gravity)

    def at(self, q: FloatArray, dq: FloatArray, tau: FloatArray) -> FloatArray:
        """Return the torques of the links in a state, shape (nq,), in N m; valid until it is asked again."""
        if self._compiled is not None:
            return self._compiled.at(q, dq, tau)
        links: FloatArray = tau - self._armature * pin.aba(self._model, self._data, q, dq, tau)
        return links
