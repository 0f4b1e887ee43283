"""Hybrid force/motion control: force normal to a wall, motion along it."""

from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base import portable
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Loop, VelocityGain
from runner.controllers.force.force_reading import ForceReading, JointTorqueReading, ReadingName, WristReading
from runner.controllers.force.tip_force import ForceTask, TipForce, TipForceConfig, TipMotion, find_force_task
from runner.controllers.operational_space.whole_body import WholeBodyParameters
from runner.robots.robot import Robot
from runner.schema.units import Newtons, PerSecond, Stiffness
from runner.sensing.force_torque import ForceTorqueConfig
from runner.symbolic.maths import Array, Backend, Scalar


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


class HybridForceParameters(NamedTuple):
    """The parameters of hybrid force and motion control."""

    law: WholeBodyParameters
    gravity: Array  # in the robot's base frame, shape (3,), in m/s^2
    normal: Array  # n, shape (3,)
    wall_stiffness: Scalar  # k, in N/m
    force: Scalar  # f_d, in N
    force_gain: Scalar  # k_f
    integral_gain: Scalar  # k_i, in 1/s
    force_damping: Scalar  # xi
    period: Scalar  # in s


class HybridForce(TipForce[HybridForceParameters]):
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
    compilable = False  # the reading needs the measured joints, which a compiled tick computes itself

    def __init__(self, task: ForceTask, config: HybridForceConfig, reading: ForceReading) -> None:
        normal, self._reading = _unit(config.normal), reading
        _check_directions(task, normal)
        parameters = HybridForceParameters(
            task.law.parameters,
            task.robot.model.gravity,
            normal,
            config.wall_stiffness,
            config.force,
            config.force_gain,
            config.integral_gain,
            config.force_damping,
            task.period,
        )
        super().__init__(task, parameters)
        self.external_wrench: FloatArray = np.zeros(6)
        """See WrenchFeedbackController."""

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v of the motion along the wall."""
        return VelocityGain(0.0, self.parameters.law.tip.k_v)

    def reset(self) -> None:
        """Clear the state of an earlier run; see Controller."""
        super().reset()
        self._reading.reset()
        self.external_wrench = np.zeros(6)

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the wrist sensor's reading; see WrenchFeedbackController."""
        self._reading.update_wrench(reading)

    def read_joint_torques(self, reading: FloatArray) -> None:
        """Store the readings of the joint torque sensors; see ControlLaw."""
        self._reading.read_joint_torques(reading)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the measured force along the normal, in N, and the integral of its error, in N s; see TorqueLaw."""
        return np.zeros(2)

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques for the present reading; see Controller.torque."""
        self.external_wrench = self._reading.wrench(q, dq)
        state = self.start(q) if self.state is None else self.state
        self.state = np.array([portable.dot(self.external_wrench[:3], self.parameters.normal), state[1]])
        return super().torque(time, q, dq, reference)

    def command(
        self, backend: Backend, parameters: HybridForceParameters, tip: TipMotion, state: Array
    ) -> tuple[Array, Array, Array]:
        """Return the acceleration along the wall and the force into it; see TipForce."""
        f, n, k_f = state[0], tip.axes.dot(parameters.normal), parameters.force_gain
        off = parameters.force - f
        state = backend.choose(
            backend.less(0.0, f), lambda: np.array([f, state[1] + parameters.period * off]), lambda: state
        )
        mass = 1.0 / n.dot(tip.mobility).dot(n)
        rate = backend.sqrt(parameters.wall_stiffness * (1.0 + k_f) / mass)
        push = parameters.force + k_f * off + parameters.integral_gain * state[1]
        push = push + 2.0 * parameters.force_damping * mass * rate * n.dot(tip.velocity)
        return tip.asked - n * n.dot(tip.asked), -push * n, state

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
    length = portable.norm(np.array(normal))
    if abs(length - 1.0) > 1e-6:
        raise ConfigError(f"controller.normal: must be a unit vector; found {normal}, of length {length:.7g}")
    return np.array(normal) / length


def _check_directions(task: ForceTask, normal: FloatArray) -> None:
    directions = task.law.parameters.tip.directions
    if len(directions) == 3:
        return
    along = float(np.linalg.norm(directions @ normal))
    names = "; ".join(str(np.round(row, 6).tolist()) for row in directions)
    if along < 1.0 - 1e-6:
        raise ConfigError(
            f"controller.normal: {task.name} cannot push along {normal.tolist()}: its tip can only move "
            f"along {names}; take one of these as normal"
        )
    if len(directions) < 2:
        raise ConfigError(
            f"controller.normal: a force along {normal.tolist()} leaves no direction of motion: the tip of "
            f"{task.name} can only move along {names}; take an arm whose tip has two directions or more"
        )
