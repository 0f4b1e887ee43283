"""External force on the tip from a wrist sensor or from joint torque sensors."""

from typing import Literal, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.force.wrist import ToolCompensation
from runner.controllers.torque_law import PinocchioArm
from runner.robots.robot import Robot
from runner.sensing.force_torque import ForceTorqueConfig

ReadingName = Literal["wrist", "joint_torque"]


class ForceReading(Protocol):
    """A measurement of the external wrench on the tip."""

    def reset(self) -> None:
        """Clear the state of an earlier run."""

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the wrist sensor's reading, shape (6,); see WrenchFeedbackController."""

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the mean torques on the links since the last tick, shape (nq,); see ControlLaw."""

    def wrench(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return force in N and moment about the tip in N m, in the base frame, shape (6,)."""
        ...


class WristReading:
    """External wrench from the wrist sensor's reading, less its bias and the tool's weight.

    Args:
        robot: The robot.
        sensor: Nominal config of the sensor.
        period: Time between two readings, in s.
    """

    def __init__(self, robot: Robot, sensor: ForceTorqueConfig, period: float) -> None:
        self._compensation = ToolCompensation(robot, sensor, "gravity", period)
        self._reading = np.zeros(6)

    def reset(self) -> None:
        """Clear the state of an earlier run; see ForceReading."""
        self._compensation.reset()
        self._reading = np.zeros(6)

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the reading; see ForceReading."""
        self._reading = reading

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Do nothing."""

    def wrench(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the wrench on the tip; see ForceReading."""
        return self._compensation.external(q, dq, self._reading)[0]


class JointTorqueReading:
    r"""External force on the tip from joint torques, by the momentum balance over the last period h.

    .. math::

        \bar d = \frac{p_k - p_{k-1}}{h} - \bar\tau - \frac{b_{k-1} + b_k}{2}, \quad p = M \dot q, \;
        b = C^T \dot q - G, \qquad \bar f = \bar J^T \bar d = \Lambda J M^{-1} \bar d

    as in MomentumObserver, without its filter. The result is the mean over the period, so it is half a period late. It
    needs no acceleration. Model errors, such as a wrong mass, appear as force.

    Args:
        robot: The nominal robot.
        period: h, in s.
    """

    def __init__(self, robot: Robot, period: float) -> None:
        self._model, self._period = robot.model, period
        self._arm = PinocchioArm(robot.model)
        self.reset()

    def reset(self) -> None:
        """Clear the state of an earlier run; see ForceReading."""
        self._before: tuple[FloatArray, FloatArray] | None = None
        self._acted: FloatArray | None = None

    def update_wrench(self, reading: FloatArray) -> None:
        """Do nothing."""

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the mean torques since the last tick; see ForceReading."""
        self._acted = reading

    def wrench(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the mean force on the tip since the last tick, with a moment of 0; see ForceReading."""
        p, b = self._arm.momentum(q, dq, self._model.gravity)
        found = np.zeros(6)
        if self._before is not None and self._acted is not None:
            p_before, b_before = self._before
            disturbance = (p - p_before) / self._period - self._acted - 0.5 * (b_before + b)
            J, M = self._model.tip_jacobian(q)[:3], self._model.mass_matrix(q)
            yields = np.linalg.solve(M, np.column_stack([J.T, disturbance]))
            found[:3] = np.linalg.lstsq(J @ yields[:, :-1], J @ yields[:, -1], rcond=None)[0]
        self._before = p.copy(), b.copy()
        return found
