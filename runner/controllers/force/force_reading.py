"""External wrench on the tip from a wrist sensor or from joint torque sensors."""

from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import eigen, pin
from runner.base.portable import dot, solve_symmetric
from runner.controllers.disturbance_observer import momentum_balance
from runner.controllers.torque_law import PinocchioArm
from runner.robots.mounting import find_tool, holding_wrench
from runner.robots.robot import Robot
from runner.sensing.force_torque import ForceTorqueConfig
from runner.sensing.wrench import cross, wrench_transform

Compensation = Literal["none", "gravity", "gravity_and_inertia"]
ReadingName = Literal["wrist", "joint_torque"]


class ToolCompensation:
    r"""External wrench on the tip and on the flange in the base frame, from the wrist sensor's reading.

    .. math:: f_e = f - f_0 - f_t

    f_0 is the nominal bias of the sensor and f_t the nominal load of the tool: its weight at the measured configuration
    and, with gravity_and_inertia, its inertial load at the measured velocity and the acceleration differenced from it.

    Args:
        robot: The robot with its tool.
        sensor: Config of the sensor.
        compensation: Subtracted loads: none, bias and weight, or also the inertial load.
        period: Time between two readings, in s.
    """

    def __init__(self, robot: Robot, sensor: ForceTorqueConfig, compensation: Compensation, period: float) -> None:
        self._model = robot.model.pin_model
        self._data = self._model.createData()
        self._tip, self._flange = robot.model.tip_frame, self._model.getFrameId(robot.flange)
        self._bias = np.zeros(6) if compensation == "none" else np.array(sensor.bias)
        self._to_flange = wrench_transform(sensor.pose)
        self._gravity = robot.model.gravity
        self._inertia = compensation == "gravity_and_inertia"
        known = compensation != "none"
        self._tool = find_tool(self._model, self._flange) if known else pin.Inertia.Zero()
        self._period = period
        self._zero = np.zeros(robot.model.nq)
        self._last: FloatArray | None = None

    def reset(self) -> None:
        """Clear the last velocity."""
        self._last = None

    def external(self, q: FloatArray, dq: FloatArray, reading: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the external wrench about the tip and about the flange's origin in the base frame, shapes (6,).

        Args:
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            reading: Sensor reading, force in N and moment in N m, shape (6,).
        """
        model, data = self._model, self._data
        ddq = self._zero if self._last is None else (dq - self._last) / self._period
        self._last = dq.copy()
        moving = (dq, ddq) if self._inertia else (self._zero, self._zero)
        pin.forwardKinematics(model, data, q, *moving)
        tip, flange = (pin.updateFramePlacement(model, data, frame) for frame in (self._tip, self._flange))
        own = self._to_flange @ (reading - self._bias)
        own += holding_wrench(model, data, self._flange, self._tool, self._gravity)
        world = pin.SE3(flange.rotation, np.zeros(3))
        at_flange = wrench_transform(world.homogeneous) @ own
        lever = flange.translation - tip.translation
        at_tip = at_flange.copy()
        at_tip[3:] += cross(lever, at_flange[:3])
        return at_tip, at_flange


class ForceReading:
    """A measurement of the external wrench on the tip."""

    def reset(self) -> None:
        """Clear the state of an earlier run."""

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the wrist sensor's reading, shape (6,); see WrenchFeedbackController."""

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the mean torques on the links since the last tick, shape (nq,); see ControlLaw."""

    def wrench(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return force in N and moment about the tip in N m, in the base frame, shape (6,)."""
        raise NotImplementedError


class WristReading(ForceReading):
    """External wrench from the wrist sensor's reading, less its bias and the tool's weight.

    Args:
        robot: The robot.
        sensor: Nominal config of the sensor.
        period: Time between two readings, in s.
    """

    def __init__(self, robot: Robot, sensor: ForceTorqueConfig, period: float) -> None:
        self._compensation = ToolCompensation(robot, sensor, "gravity", period)
        self.reset()

    def reset(self) -> None:
        """Clear the state of an earlier run; see ForceReading."""
        self._compensation.reset()
        self._reading = np.zeros(6)

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the reading; see ForceReading."""
        self._reading = reading

    def wrench(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the wrench on the tip; see ForceReading."""
        return self._compensation.external(q, dq, self._reading)[0]


class JointTorqueReading(ForceReading):
    r"""External force on the tip from joint torques and the momentum balance of MomentumObserver.

    .. math:: \bar f = \bar J^T \bar d = \Lambda J M^{-1} \bar d

    The result is the mean over the period, so it is half a period late. It needs no acceleration. Model errors, such as
    a wrong mass, appear as force.

    Args:
        robot: The nominal robot.
        period: Time between two readings, in s.
    """

    def __init__(self, robot: Robot, period: float) -> None:
        self._model, self._period = robot.model, period
        self._arm = PinocchioArm(robot.model)
        self.reset()

    def reset(self) -> None:
        """Clear the state of an earlier run; see ForceReading."""
        self._before: FloatArray | None = None
        self._acted = np.zeros(self._model.nq)

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the mean torques since the last tick; see ForceReading."""
        self._acted = reading

    def wrench(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the mean force on the tip since the last tick, with a moment of 0; see ForceReading."""
        h, J, M = self._period, self._model.tip_jacobian(q)[:3], self._model.mass_matrix(q)
        p, b = self._arm.momentum(q, dq, self._model.gravity)
        before = p - 0.5 * h * b if self._before is None else self._before  # no disturbance before the first tick
        disturbance, self._before = momentum_balance(p, b, h, before, self._acted)
        yields = solve_symmetric(M, np.column_stack([J.T, disturbance]))
        force = eigen.CompleteOrthogonalDecomposition(J @ yields[:, :-1]).solve(dot(J, yields[:, -1]))
        return np.concatenate([force, np.zeros(3)])
