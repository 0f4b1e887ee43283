"""Whole-body operational-space control of a redundant arm, with a dynamically consistent null space."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Loop, VelocityGain
from runner.controllers.operational_space.tip_task import TipNumbers, TipTask
from runner.controllers.operational_space.whole_body_posture import JointStiffness, Posture, PostureNumbers, PostureTask
from runner.controllers.torque_law import Arm, TorqueLaw
from runner.robots import RobotModel
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import MetresPerSecond, RadiansPerSecond, Seconds
from runner.symbolic.maths import Array, Scalar


class WholeBodyLaw(StrictModel):
    """Config of the whole-body law.

    Attributes:
        natural_frequency: omega_n of the closed loop in every direction of the tip, in rad/s.
        damping_ratio: xi of the closed loop.
        gravity_compensation: True if the law includes the gravity term.
        feedforward: True if the law uses the desired velocity and acceleration.
        null_space_frequency: omega_n of the posture task in the null space, in rad/s; it pulls joints home and damps
            all joints.
        max_tip_speed: Tip speed at which the approach to the goal saturates, in m/s; None for no limit.
        singularity_damping: Damping of the inverse of J M^-1 J^T near a singular configuration, as a fraction of the
            tip error; 0 for the law in the thesis.
    """

    natural_frequency: RadiansPerSecond[PositiveFloat]
    damping_ratio: PositiveFloat
    gravity_compensation: bool
    feedforward: bool
    null_space_frequency: RadiansPerSecond[NonNegativeFloat]
    max_tip_speed: MetresPerSecond[PositiveFloat | None]
    singularity_damping: NonNegativeFloat


class WholeBodyConfig(WholeBodyLaw):
    """Config of whole-body control.

    Attributes:
        kind: Registry name of the controller.
        period: Time between two ticks, in s.
    """

    kind: Literal["whole_body"]
    period: Seconds[PositiveFloat]


class WholeBodyNumbers(NamedTuple):
    """The numbers of the whole-body law: those of the tip task and of the posture task."""

    tip: TipNumbers
    posture: PostureNumbers


class TaskState(NamedTuple):
    """State of the tip task of an arm, along the rows of the task.

    Attributes:
        q: Joint positions of the arm, shape (n,), in rad.
        dq: Joint velocities of the arm, shape (n,), in rad/s.
        x: Position of the tip in the base frame, shape (3,), in m.
        J: Jacobian, shape (rows, n).
        dJ_dq: dJ/dt dq, shape (rows,), in m/s^2 and rad/s^2.
        M_inverse_J: M^-1 J^T, shape (n, rows).
        error: Desired less actual position and orientation, shape (rows,), in m and rad.
        velocity: Velocity of the tip, shape (rows,), in m/s and rad/s.
    """

    q: Array
    dq: Array
    x: Array
    J: Array
    dJ_dq: Array  # noqa: N815 - as the papers write it
    M_inverse_J: Array
    error: Array
    velocity: Array

    @property
    def mobility(self) -> Array:
        """Lambda^-1 = J M^-1 J^T, shape (rows, rows), in 1/kg."""
        return np.asarray(self.J.dot(self.M_inverse_J))


class WholeBody(TorqueLaw[WholeBodyNumbers]):
    r"""Operational-space control of the tip of an arm with more joints than the task needs (thesis method 1).

    .. math::

        \tau = h + J^T \Lambda (F^* - \dot J \dot q) + N^T \tau_0, \qquad
        \Lambda = (J M^{-1} J^T)^{-1}, \quad \bar J = M^{-1} J^T \Lambda, \quad N^T = 1 - J^T \bar J^T

    F* is that of TipTask, for the tip's position or, with an orientation, its pose. tau_0 is the torque of the posture
    task, JointStiffness or PostureTask. J M^-1 N^T = 0, so tau_0 does not accelerate the tip.

    Args:
        model: The whole arm.
        config: Config of the law.
        rest: Configuration of the posture task, shape (nq,), in rad.
        first_held: Index of the first joint with a spring (JointStiffness); all later joints also have one. None leaves
            as many joints free as the task has dimensions, so that springs hold the mounted Minis. 0 uses PostureTask.
        orientation: Desired orientation of the tip in the base frame, shape (3, 3); None for position control.

    Raises:
        ConfigError: if the arm has fewer joints than the tip has directions of motion.
    """

    def __init__(
        self,
        model: RobotModel,
        config: WholeBodyLaw,
        rest: FloatArray,
        first_held: int | None = None,
        orientation: FloatArray | None = None,
    ) -> None:
        self._task = TipTask(model, orientation, config, config.max_tip_speed)
        self._task.check_joints(model)
        frequency = config.null_space_frequency
        first_held = self._task.rows if first_held is None else first_held
        self._posture: Posture = (
            JointStiffness(model, frequency, rest, first_held) if first_held else PostureTask(frequency, rest)
        )
        numbers = WholeBodyNumbers(self._task.numbers, self._posture.numbers)
        super().__init__([model], config.gravity_compensation, numbers)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        tip, posture = self.numbers
        spare = self.models[0].nq > len(tip.directions)
        return VelocityGain(0.0, max(tip.k_v, posture.k_v) if spare else tip.k_v)

    def evaluate(
        self,
        arms: Sequence[Arm],
        numbers: WholeBodyNumbers,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        memory: Array,
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see TorqueLaw."""
        (arm,) = arms
        return self.control(arm, numbers, q, dq, reference), memory

    def control(
        self,
        arm: Arm,
        numbers: WholeBodyNumbers,
        q: Array,
        dq: Array,
        reference: Array,
        gravity: Array | None = None,
    ) -> Array:
        """Return the torques of the law above; see Arm.inverse_dynamics for gravity, TorqueLaw for the others."""
        task = self.task_state(arm, numbers, q, dq, reference)
        return self.joint_torques(arm, numbers, task, self.acceleration(arm, numbers, task, reference), None, gravity)

    def task_state(self, arm: Arm, numbers: WholeBodyNumbers, q: Array, dq: Array, reference: Array) -> TaskState:
        """Return the state of the tip task; see TorqueLaw for the arguments."""
        tip = arm.tip(q, dq)
        J, dJ_dq = self._task.jacobian(numbers.tip, tip)
        error = self._task.error(arm.backend, numbers.tip, tip, reference)
        M_inverse_J = arm.backend.solve_symmetric(arm.mass_matrix(q), J.T, "the mass matrix is singular")
        return TaskState(q, dq, tip.x, J, dJ_dq, M_inverse_J, error, J.dot(dq))

    def acceleration(self, arm: Arm, numbers: WholeBodyNumbers, task: TaskState, reference: Array) -> Array:
        """Return F* of TipTask, shape (rows,), in m/s^2 and rad/s^2."""
        return self._task.acceleration(arm.backend, numbers.tip, task.error, task.velocity, reference)

    def joint_torques(
        self,
        arm: Arm,
        numbers: WholeBodyNumbers,
        task: TaskState,
        acceleration: Array,
        force: Array | None = None,
        gravity: Array | None = None,
    ) -> Array:
        r"""Return the torques for an acceleration a and an additional force F of the tip.

        .. math:: \tau = h + J^T (\Lambda (a - \dot J \dot q) + F) + N^T \tau_0

        Args:
            arm: The arm.
            numbers: Numbers of the law.
            task: State of the tip task.
            acceleration: a along the rows of the task, shape (rows,).
            force: F along the rows of the task, shape (rows,), in N; None for no force.
            gravity: See Arm.inverse_dynamics.
        """
        backend, J = arm.backend, task.J
        F = acceleration - task.dJ_dq
        # N^T tau_0 = tau_0 - J^T Lambda J M^-1 tau_0, and tau_0 = M ddq_0 + spring.
        ddq_0, spring = self._posture.acceleration_and_torque(backend, numbers.posture, J, task.q, task.dq)
        F = F - J.dot(ddq_0)
        if spring is not None:
            F = F - task.M_inverse_J.T.dot(spring)
        mobility = self._task.damp(backend, numbers.tip, J, task.error, task.mobility)
        moving = backend.solve_symmetric(mobility, F, "the tip's Jacobian is singular")
        if force is not None:
            moving = moving + force
        torque: Array = arm.inverse_dynamics(task.q, task.dq, ddq_0, gravity) + J.T.dot(moving)
        return torque if spring is None else torque + spring


CONFIG = WholeBodyConfig


def build(config: WholeBodyConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the single loop of a config; it commands every joint.

    Springs hold the joints of mounted arms at home. If the robot has one stage, the law pulls all joints home.
    """
    joints, first_held = slice(0, robot.model.nq), 0 if len(robot.stages) == 1 else None
    return (Loop("whole", joints, config.period, WholeBody(robot.model, config, robot.home, first_held)),)
