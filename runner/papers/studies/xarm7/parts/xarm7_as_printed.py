"""Resolved-motion control with the xArm7 report's printed Jacobian and pseudo-inverse, each error selectable."""

from typing import Literal

import numpy as np
import pinocchio as pin
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.portable import cross
from runner.controllers.controller import Loop, PositionController
from runner.controllers.operational_space.tip_task import TaskName, task_start
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import PerSecond, Seconds

COMMANDS = "position"


class AsPrintedConfig(StrictModel):
    """Config of the printed law.

    Attributes:
        kind: Its name in the registry.
        period: Time between two commands, in s.
        task: Whether its first three rows are taken, for the tip's position, or all six.
        columns: Column k of the Jacobian as printed, the true column k - 1 (and the first twice), or right.
        angles: The angles behind l4 and l5 as printed, q1, q5 and q2, or theta1 and theta2.
        inverse: The pseudo-inverse as printed, (J^T J)^-1 J^T, or J^T (J J^T)^-1.
        gain: K of the tip's error, in 1/s; the report says nothing of it.
        feedforward: Whether the law knows the desired velocity.
    """

    kind: Literal["xarm7_as_printed"]
    period: Seconds[PositiveFloat]
    task: TaskName
    columns: Literal["printed", "right"]
    angles: Literal["printed", "right"]
    inverse: Literal["printed", "right"]
    gain: PerSecond[NonNegativeFloat]
    feedforward: bool


class PrintedJacobian:
    r"""The Jacobian of the xArm7 report, entries J11 to J67, in its own errors or without them.

    Its columns are b_{i-1} x r_{i-1,E} over b_{i-1}, taken from the frame before each joint: as the constant part of
    the report's transforms comes first, that frame turns with the joint before, and column k is the true column k - 1.
    The last true column is missing, and the first appears twice. The lengths l4 and l5 are multiplied by the
    cosines and sines of q1, of q5 and of q2, where the constants theta1 and theta2 are meant.

    Args:
        model: The xArm7.
        columns: Whether the columns are shifted as printed.
        angles: Whether the angles are mistaken as printed.
    """

    def __init__(self, model: RobotModel, columns: bool, angles: bool) -> None:
        placements = list(model.pin_model.jointPlacements)[1:]
        self._placements = [(placement.translation.copy(), placement.rotation.copy()) for placement in placements]
        self._l4, self._l5 = (float(np.hypot(*self._placements[joint][0][:2])) for joint in (4, 6))
        self._columns = [0, 0, 1, 2, 3, 4, 5] if columns else list(range(7))
        self._angles = angles

    def __call__(self, q: FloatArray) -> FloatArray:
        """Return the Jacobian at joint positions, shape (6, 7), in m and 1: linear rows first, base frame."""
        origins, axes = np.empty((7, 3)), np.empty((7, 3))
        p, R = np.zeros(3), np.eye(3)
        for joint, (translation, rotation) in enumerate(self._placements):
            p = p + R @ self._translation(joint, translation, q)
            R = R @ rotation @ pin.rpy.rpyToMatrix(0.0, 0.0, q[joint])
            origins[joint], axes[joint] = p, R[:, 2]
        J = np.vstack([cross(axes, p - origins).T, axes.T])
        return J[:, self._columns]

    def _translation(self, joint: int, right: FloatArray, q: FloatArray) -> FloatArray:
        """Return a joint's place in the frame before it: (l sin, -l cos, 0) of l4, (l sin, l cos, 0) of l5."""
        if self._angles and joint == 4:
            return np.array([self._l4 * np.sin(q[0]), -self._l4 * np.cos(q[0]), 0.0])
        if self._angles and joint == 6:
            return np.array([self._l5 * np.sin(q[1]), self._l5 * np.cos(q[4]), 0.0])
        return right


class AsPrinted(PositionController):
    r"""Resolved motion by the printed Jacobian and the printed pseudo-inverse.

    .. math:: q_c = q + h \, (J^T J)^{-1} J^T \, (\dot x_d + K (x_d - x))

    J^T J of a 3 x 7 or 6 x 7 Jacobian has rank 3 or 6 and order 7: it has no inverse. In floating point it may have
    one, made of rounding errors. The tip x is the true one.

    Args:
        model: The xArm7.
        config: Which of the errors.
        home: Joint positions at home, shape (7,), in rad; their orientation is held where the task is the pose.
    """

    def __init__(self, model: RobotModel, config: AsPrintedConfig, home: FloatArray) -> None:
        if model.nq != 7:
            raise ConfigError(
                f"controller.kind: xarm7_as_printed is of the xArm7's seven joints; the arm has {model.nq}"
            )
        self._model = model
        self._jacobian = PrintedJacobian(model, config.columns == "printed", config.angles == "printed")
        self._config = config
        self._rows = 3 if config.task == "position" else 6
        self._orientation = model.tip_pose(home)[:3, :3]

    def reset(self, q: FloatArray) -> None:
        """Do nothing: the law has no memory."""

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the next command; see PositionController.joint_positions."""
        pose, gain = self._model.tip_pose(q), self._config.gain
        v = gain * (reference[0] - pose[:3, 3])
        if self._config.feedforward:
            v += reference[1]
        if self._rows == 6:
            v = np.concatenate([v, gain * pin.log3(self._orientation @ pose[:3, :3].T)])
        J = self._jacobian(q)[: self._rows]
        if self._config.inverse == "printed":
            velocity = np.linalg.inv(J.T @ J) @ (J.T @ v)
        else:
            velocity = J.T @ np.linalg.solve(J @ J.T, v)
        return np.asarray(q + self._config.period * velocity)


CONFIG = AsPrintedConfig


def build(config: AsPrintedConfig, robot: Robot) -> tuple[Loop, ...]:
    """Make the one loop that a config describes.

    Raises:
        ConfigError: if the arm has another number of joints than seven.
    """
    controller = AsPrinted(robot.model, config, robot.home)
    return (Loop(robot.stage_names[-1], slice(0, robot.model.nq), config.period, controller),)


def start_posture(config: AsPrintedConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return the joint positions at a trajectory's start: for a pose, with home's orientation."""
    return task_start(config.task, robot, start)
