"""Hybrid force/motion control: force normal to a wall, motion along it."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Controller, Loop, VelocityGain
from runner.controllers.force.force_reading import ForceReading, JointTorqueReading, ReadingName, WristReading
from runner.controllers.force.tip_force import ForceTask, TipForceConfig, find_force_task
from runner.robots.robot import Robot
from runner.schema.units import Newtons, PerSecond, Stiffness
from runner.sensing.force_torque import ForceTorqueConfig


class HybridForceConfig(TipForceConfig):
    """Config of hybrid force and motion control, with motion along a wall.

    Attributes:
        kind: Registry name of the controller.
        normal: Nominal normal out of the wall, a unit vector in the base frame.
        wall_stiffness: Nominal stiffness of the wall, in N/m; it sets the damping.
        force: Desired contact force f_d, in N.
        force_gain: Gain k_f of the force error; 0 leaves f_d unchanged.
        integral_gain: Integral gain k_i of the force error, in 1/s; 0 for no integral. It integrates only in contact.
        force_damping: xi of the motion into the wall.
        force_source: Source of the contact force: the wrist sensor or the joint torque sensors.
        sensor: Nominal config of the wrist sensor: bias, rotation and height.
    """

    kind: Literal["hybrid_force"]
    normal: Annotated[list[float], Field(min_length=3, max_length=3)]
    wall_stiffness: Stiffness[PositiveFloat]
    force: Newtons[PositiveFloat]
    force_gain: NonNegativeFloat
    integral_gain: PerSecond[NonNegativeFloat]
    force_damping: NonNegativeFloat
    force_source: ReadingName
    sensor: ForceTorqueConfig


class HybridForce(Controller):
    r"""Force along a wall's normal n, motion along its face (Khatib 1987; Raibert and Craig 1981).

    .. math::

        \tau = J^T [\Lambda (\Omega F^* - \dot J \dot q) - n (f_d + k_f (f_d - f) + k_i \int (f_d - f) dt
        + 2 \xi m_n \omega_c \, n \cdot v)] + V + G + N^T \tau_0, \qquad \Omega = 1 - n n^T

    with the tip's mass along the normal m_n = 1 / (n^T Lambda^-1 n) and omega_c = sqrt(k (1 + k_f) / m_n). With k_i = 0
    and a wall of the nominal stiffness k, the depth d obeys

    .. math:: m_n \ddot d + 2 \xi m_n \omega_c \dot d + k (1 + k_f) \, d = (1 + k_f) f_d

    Before contact the tip approaches the wall at (1 + k_f) f_d / (2 xi m_n omega_c). F* is that of TipTask.

    Args:
        task: Force task of the robot.
        config: Config of the law.
        reading: Measurement of the contact force.

    Raises:
        ConfigError: if the arm cannot push along the normal, or has no other direction of motion.
    """

    reads_joint_torques = True

    def __init__(self, task: ForceTask, config: HybridForceConfig, reading: ForceReading) -> None:
        self._tip, self._config, self._period, self._reading = task.tip, config, task.period, reading
        self._normal = _unit(config.normal)
        _check_directions(task, self._normal)
        self.external_wrench: FloatArray = np.zeros(6)
        """See WrenchFeedbackController."""
        self.reset()

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v of the motion along the wall."""
        return self._tip.velocity_gain

    def reset(self) -> None:
        """Clear the state of an earlier run; see Controller."""
        self._reading.reset()
        self._sum, self.external_wrench = 0.0, np.zeros(6)

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the wrist sensor's reading; see WrenchFeedbackController."""
        self._reading.update_wrench(reading)

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the readings of the joint torque sensors; see ControlLaw."""
        self._reading.read_joint_torques(reading)

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the law above; see Controller.torque."""
        config = self._config
        self.external_wrench = self._reading.wrench(q, dq)
        f = float(self.external_wrench[:3] @ self._normal)
        state = self._tip.task_state(q, dq, reference)
        n = state.axes @ self._normal
        if f > 0.0:
            self._sum += self._period * (config.force - f)
        mass = 1.0 / float(n @ state.mobility @ n)
        rate = np.sqrt(config.wall_stiffness * (1.0 + config.force_gain) / mass)
        push = config.force + config.force_gain * (config.force - f) + config.integral_gain * self._sum
        push += 2.0 * config.force_damping * mass * rate * float(n @ state.velocity)
        return self._tip.torque(state, state.asked - n * (n @ state.asked), -push * n)

    def messages(self) -> list[str]:
        """Return nothing; see WrenchFeedbackController."""
        return []


CONFIG = HybridForceConfig


def build(config: HybridForceConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the loops of a config: one, or one for each stage if only the last stage pushes.

    Raises:
        ConfigError: if a value is missing for a stage, or the arm has too few joints or cannot push and move.
    """
    task = find_force_task(config, robot)
    reading: ForceReading = (
        WristReading(robot, config.sensor, task.period)
        if config.force_source == "wrist"
        else JointTorqueReading(robot, task.period)
    )
    return task.loops(HybridForce(task, config, reading), uses_wrench=True)


def _unit(normal: list[float]) -> FloatArray:
    length = float(np.linalg.norm(normal))
    if abs(length - 1.0) > 1e-6:
        raise ConfigError(f"controller.normal: must be a unit vector; found {normal}, of length {length:.7g}")
    return np.array(normal) / length


def _check_directions(task: ForceTask, normal: FloatArray) -> None:
    directions = task.tip.directions
    if len(directions) == 3:
        return
    along = float(np.linalg.norm(directions @ normal))
    names = "; ".join(str(np.round(row, 6).tolist()) for row in directions)
    if along < 1.0 - 1e-6:
        raise ConfigError(
            f"controller.normal: {task.name} cannot push along {normal.tolist()}, as its tip goes along "
            f"{names} alone; take a normal among these"
        )
    if len(directions) < 2:
        raise ConfigError(
            f"controller.normal: a force along {normal.tolist()} leaves no direction to move in, as the tip of "
            f"{task.name} goes along {names} alone; take an arm whose tip has two directions or more"
        )
