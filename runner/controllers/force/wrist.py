"""External wrench on the tool from the wrist sensor."""

from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.robots.robot import Robot
from runner.robots.tool_link import find_tool, holding_wrench
from runner.sensing.force_torque import ForceTorqueConfig
from runner.sensing.wrench import cross, wrench_transform

Compensation = Literal["none", "gravity", "gravity_and_inertia"]


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
