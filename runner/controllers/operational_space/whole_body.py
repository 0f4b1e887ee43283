"""Whole-body operational-space control of a redundant arm, with a dynamically consistent null space."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

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
        return self.lead(arm, numbers, q, dq, reference), memory

    def lead(
        self,
        arm: Arm,
        numbers: WholeBodyNumbers,
        q: Array,
        dq: Array,
        reference: Array,
        gravity: Array | None = None,
    ) -> Array:
        """Return the torques of the law above; see Arm.inverse_dynamics for gravity, TorqueLaw for the others."""
        backend, task, tip = arm.backend, self._task, arm.tip(q, dq)
        J, dJ_dq = task.jacobian(numbers.tip, tip)
        error = task.error(backend, numbers.tip, tip, reference)
        M_inverse_J = backend.solve_symmetric(arm.mass_matrix(q), J.T, "the mass matrix is singular")
        F = task.acceleration(backend, numbers.tip, error, J.dot(dq), reference) - dJ_dq
        # N^T tau_0 = tau_0 - J^T Lambda J M^-1 tau_0, and tau_0 = M ddq_0 + spring.
        ddq_0, spring = self._posture.acceleration_and_torque(backend, numbers.posture, J, q, dq)
        F = F - J.dot(ddq_0)
        if spring is not None:
            F = F - M_inverse_J.T.dot(spring)
        mobility = task.damp(backend, numbers.tip, J, error, J.dot(M_inverse_J))
        force = backend.solve_symmetric(mobility, F, "the tip's Jacobian is singular")
        torque: Array = arm.inverse_dynamics(q, dq, ddq_0, gravity) + J.T.dot(force)
        return torque if spring is None else torque + spring


CONFIG = WholeBodyConfig


def build(config: WholeBodyConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the single loop of a config; it commands every joint.

    Springs hold the joints of mounted arms at home. If the robot has one stage, the law pulls all joints home.
    """
    joints, first_held = slice(0, robot.model.nq), 0 if len(robot.stages) == 1 else None
    return (Loop("whole", joints, config.period, WholeBody(robot.model, config, robot.home, first_held)),)
