"""Closed-loop inverse kinematics: integrated joint velocities with tip error feedback."""

from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.controllers.controller import Loop, PositionController
from runner.controllers.kinematic.resolved_rate import NullSpaceConfig, NullSpaceTask, ResolvedRate
from runner.controllers.operational_space.tip_task import TaskName, held_orientation, task_start
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.robots.task_space import task_basis
from runner.schema.model import StrictModel
from runner.schema.units import PerSecond, Seconds
from runner.schema.values import PositivePerJoint, expand

COMMANDS = "position"
FOLLOWS_PATHS = True

# Explicit Runge-Kutta rules: position of each slope in the period, along the slope before, and its weight.
_RULES = {
    "euler": ((0.0,), (1.0,)),
    "midpoint": ((0.0, 0.5), (0.0, 1.0)),
    "rk4": ((0.0, 0.5, 0.5, 1.0), (1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0)),
}
_Tip = tuple[FloatArray, FloatArray, FloatArray]  # position, rotation, basic Jacobian


class DifferentialInverseKinematicsConfig(StrictModel):
    """Config of differential inverse kinematics.

    Attributes:
        kind: Registry name of the controller.
        period: Time between two commands, in s.
        task: Controlled tip motion: the position, or the pose with the orientation of home.
        gain: K, the decay rate of a tip error, in 1/s; at most 1 / period.
        feedforward: True if the law uses the derivatives of the desired motion; False to follow a moving goal.
        feedback: Joint positions at which the tip error is taken: measured or commanded.
        integration: Rule that integrates joint velocities from one command to the next.
        damping: Singular value below which the inverse is damped, as a fraction of the arm's reach; 0 for no damping.
        weights: Cost of the motion of each joint; one for all joints or a list with one for each.
        null_space: Config of the null-space task.
    """

    kind: Literal["differential_inverse_kinematics"]
    period: Seconds[PositiveFloat]
    task: TaskName
    gain: PerSecond[NonNegativeFloat]
    feedforward: bool
    feedback: Literal["measured", "commanded"]
    integration: Literal["euler", "midpoint", "rk4"]
    damping: NonNegativeFloat
    weights: PositivePerJoint
    null_space: NullSpaceConfig


class DifferentialInverseKinematics(PositionController):
    r"""Closed-loop inverse kinematics: joint velocities for the tip motion, integrated to joint positions.

    .. math:: \dot q = J^\# (\dot x_d + K (x_d - x)) + (1 - J^\# J) \dot q_0

    J^# is that of ResolvedRate, within the speed and position limits of the URDF. q0' is the velocity of the null-space
    task. A pose keeps the orientation of home: the angular error is the rotation vector from the tip's orientation to
    it, in the base frame. Each command continues from the last command. Feedback of the measured tip error removes the
    steady-state error of a servo, as integral action would, and measurement noise enters only through K.

    Args:
        model: The arm.
        config: Config of the law.
        home: Joint positions at home, shape (nq,), in rad.

    Raises:
        ConfigError: if the task has more dimensions than the arm has joints, a list has the wrong length, or the gain
            is above 1 / period.
    """

    def __init__(self, model: RobotModel, config: DifferentialInverseKinematicsConfig, home: FloatArray) -> None:
        _check_gain(config)
        self._orientation = held_orientation(config.task, model, home)
        self._directions = task_basis(model, config.task == "pose")
        self._whole = len(self._directions) == self._directions.shape[1]
        self._model = pin.Model(model.pin_model)
        self._data = self._model.createData()
        self._tip = model.tip_frame
        self._period = config.period
        self._gain = config.gain
        self._feedforward = config.feedforward
        self._measured = config.feedback == "measured"
        self._rule = tuple(zip(*_RULES[config.integration], strict=True))
        weights = np.array(expand("controller.weights", config.weights, model.joint_names))
        self._resolved_rate = ResolvedRate(weights, config.damping * model.reach)
        posture, key = config.null_space.posture, "controller.null_space.posture"
        rest = home if posture is None else np.array(expand(key, posture, model.joint_names))
        self._null_space = NullSpaceTask(config.null_space, rest, model.position_limits)
        self._speed_limits = model.velocity_limits
        self._position_limits = model.position_limits
        self._command = home.copy()

    def reset(self, q: FloatArray) -> None:
        """Start from joint positions; see PositionController."""
        self._command = q.copy()

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the next command; see PositionController.joint_positions."""
        command, slope, motion = self._command, np.zeros_like(q), np.zeros_like(q)
        tip = self._tip_at(command)
        off, turn = self._tip_offset(q, tip) if self._measured else (np.zeros(3), None)
        bounds = (self._position_limits - command) / self._period
        bounds = np.minimum(np.maximum(bounds, -self._speed_limits), self._speed_limits)
        for place, weight in self._rule:
            ahead = place * self._period
            at = command
            if ahead:
                at = command + ahead * slope
                tip = self._tip_at(at)
            slope = self._joint_velocity(at, tip, ahead, off, turn, reference, bounds)
            motion += weight * slope
        self._command = command + self._period * motion
        return self._command

    def _tip_offset(self, q: FloatArray, commanded: _Tip) -> tuple[FloatArray, FloatArray | None]:
        """Return the way and, for a pose, the rotation from the commanded tip to the measured one."""
        x, R, _ = self._tip_at(q)
        return x - commanded[0], None if self._orientation is None else R @ commanded[1].T

    def _joint_velocity(
        self,
        q: FloatArray,
        tip: _Tip,
        ahead: float,
        off: FloatArray,
        turn: FloatArray | None,
        reference: FloatArray,
        bounds: FloatArray,
    ) -> FloatArray:
        """Return the bounded joint velocities of the law at joint positions commanded for a time ahead, in s."""
        (x, R, J), (x_d, dx_d, ddx_d) = tip, reference
        v = self._gain * (x_d - x - off)
        if self._feedforward:
            v += dx_d if not ahead else dx_d + ahead * ddx_d + self._gain * (ahead * dx_d + 0.5 * ahead**2 * ddx_d)
        if self._orientation is not None:
            turned = R if turn is None else turn @ R
            v = np.concatenate([v, self._gain * pin.log3(self._orientation @ turned.T)])
        dq0 = self._null_space.velocity(q, J, self._directions)
        task, wanted = J[: len(v)], v
        if not self._whole:
            task, wanted = self._directions.dot(task), self._directions.dot(v)
        return self._resolved_rate.solve(task, wanted, dq0, *bounds)

    def _tip_at(self, q: FloatArray) -> _Tip:
        J = pin.computeFrameJacobian(self._model, self._data, q, self._tip, pin.LOCAL_WORLD_ALIGNED)
        placement = self._data.oMf[self._tip]
        return placement.translation.copy(), placement.rotation.copy(), J


def _check_gain(config: DifferentialInverseKinematicsConfig) -> None:
    if config.gain * config.period > 1.0 + 1e-9:
        raise ConfigError(
            f"controller.gain: {config.gain:g} 1/s times controller.period, {config.period:g} s, is above 1: the "
            f"error would overshoot at each tick; allowed: up to {1.0 / config.period:g}"
        )


CONFIG = DifferentialInverseKinematicsConfig


def build(config: DifferentialInverseKinematicsConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the single loop of a config; it commands every joint.

    Raises:
        ConfigError: see DifferentialInverseKinematics.
    """
    controller = DifferentialInverseKinematics(robot.model, config, robot.home)
    return (Loop(robot.stage_names[-1], slice(0, robot.model.nq), config.period, controller),)


def start_posture(config: DifferentialInverseKinematicsConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return the joint positions at the start; see task_start."""
    return task_start(config.task, robot, start)
