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
    """Config of hybrid force and motion control; the motion is that along the wall.

    Attributes:
        kind: Registry name of the controller.
        normal: Out of the wall, as it is believed, a unit vector along the base's axes.
        wall_stiffness: Of the wall, as it is believed, in N/m; it sets the damping.
        force: f_d, how hard the tip is to push, in N.
        force_gain: k_f of the force's error; 0 leaves f_d as it is.
        integral_gain: k_i, in 1/s; 0 is none. It integrates while something is felt.
        force_damping: xi of the motion into the wall.
        force_source: Where the force is read: at the wrist, or from torque sensors in the joints.
        sensor: What is believed of the wrist's sensor: its bias, rotation and height.
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

    with the tip's mass along the normal m_n = 1 / (n^T Lambda^-1 n) and omega_c = sqrt(k (1 + k_f) / m_n), so that on
    a wall of the believed stiffness k

    .. math:: m_n \ddot d + 2 \xi m_n \omega_c \dot d + k (1 + k_f) \, d = (1 + k_f) f_d

    of the depth d. Before the wall is felt the tip goes there at (1 + k_f) f_d / (2 xi m_n omega_c). F* is TipTask's.

    Args:
        task: What pushes.
        config: The law's numbers.
        reading: What reads the force.

    Raises:
        ConfigError: where the arm cannot push along the normal, or that leaves no direction to move in.
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
        """Forget an earlier run; see Controller."""
        self._reading.reset()
        self._sum, self.external_wrench = 0.0, np.zeros(6)

    def update_wrench(self, reading: FloatArray) -> None:
        """Take the wrist sensor's reading; see WrenchFeedbackController."""
        self._reading.update_wrench(reading)

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Take the joint torque sensors' reading; see ControlLaw."""
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
    """Make the loops that a config describes: one, or one for each stage where the last one pushes alone.

    Raises:
        ConfigError: where a value misses a stage, the arm has too few joints, or cannot push and move.
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
