"""Whole-body operational-space control of a redundant arm, with posture tasks in its null space."""

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple, Protocol, Self

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Loop, VelocityGain
from runner.controllers.operational_space.tip_task import TipParameters, TipTask
from runner.controllers.torque_law import Arm, Arms, TorqueLaw, second_order
from runner.robots.drawn import each_run
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import MetresPerSecond, RadiansPerSecond, Seconds
from runner.schema.values import by_stage
from runner.symbolic.maths import Array, Backend, Scalar


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

    @classmethod
    def of_stage(cls, config: StrictModel, names: Sequence[str], index: int, **own: Any) -> Self:
        """Return the law of a stage from a config with these keys; frequencies and damping ratio are by stage.

        Args:
            config: The config.
            names: Names of the stages.
            index: Index of the stage.
            own: Values that replace those of the config.

        Raises:
            ConfigError: if a value is missing for a stage.
        """
        values = {"max_tip_speed": None} | {key: value for key, value in config if key in cls.model_fields}
        for key in ("natural_frequency", "damping_ratio", "null_space_frequency"):
            if key not in own:
                values[key] = by_stage(f"controller.{key}", values[key], names)[index]
        return cls(**(values | own))


class WholeBodyConfig(WholeBodyLaw):
    """Config of whole-body control.

    Attributes:
        kind: Registry name of the controller.
        period: Time between two ticks, in s.
    """

    kind: Literal["whole_body"]
    period: Seconds[PositiveFloat]


class PostureParameters(NamedTuple):
    """The parameters of a posture task."""

    k_p: Scalar  # omega_n^2, in 1/s^2
    k_v: Scalar  # 2 omega_n, in 1/s
    rest: Array  # desired configuration, shape (nq,), in rad
    stiffness: Array  # K of the springs, shape (nq, nq), in N m/rad


class Posture(Protocol):
    """A posture task; its torque is M a + s, before the projection into the null space of the tip task."""

    @property
    def parameters(self) -> PostureParameters:
        """Parameters of the task."""
        ...

    def acceleration_and_torque(
        self, backend: Backend, parameters: PostureParameters, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return a joint acceleration a, in rad/s^2, and a torque s, in N m or None, both of shape (nq,).

        Args:
            backend: Functions over the scalars of these arrays.
            parameters: Parameters of the task.
            J: Jacobian of the tip task, shape (rows, nq).
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, shape (nq,), in rad/s.
        """
        ...


class JointStiffness:
    r"""Posture task with springs on the joints from `first` on, and damping of all joints.

    .. math:: \tau_0 = -k_{vn} M \dot q - K (q - q_\mathrm{rest})

    With damping only, a Mini on a Macro would stretch. K is constant, symmetric, and zero for the free joints. Because
    it is a spring, the posture only loses energy while the tip rests. K is omega_n^2 times the inertia of the held
    joints at q_rest with the tip fixed, so their natural frequency there is omega_n. An acceleration M S (q - q_rest)
    would not be a spring: at home N^T cancels it if it acts on a single Mini joint.

    Args:
        model: The arm.
        frequency: omega_n of the posture, in rad/s.
        rest: Desired configuration, shape (nq,), in rad.
        first: Index of the first joint with a spring; the joints before it stay free for the tip task.
    """

    def __init__(self, model: RobotModel, frequency: float, rest: FloatArray, first: int) -> None:
        stiffness = frequency**2 * _inertia_at_rest(model, rest, first)
        self.parameters = PostureParameters(*second_order(frequency, 1.0), rest, stiffness)

    def acceleration_and_torque(
        self, backend: Backend, parameters: PostureParameters, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return -k_vn dq and the torque of the springs; see Posture."""
        return -parameters.k_v * dq, parameters.stiffness.dot(parameters.rest - q)


class PostureTask:
    r"""Posture task that pulls all joints to a configuration, as far as the tip task allows.

    .. math:: \tau_0 = M (1 - J^+ J) (-2 \omega_n \dot q - \omega_n^2 (q - q_\mathrm{rest}))

    While the tip rests, |dq|^2 + omega_n^2 |q - q_rest|^2 decreases, and the arm ends at the nearest configuration to
    q_rest by joint angles. Springs in proportion to the joint inertias would weight the distance by inertia: they turn
    the light wrist of an arm by radians before they move the heavy shoulder.

    Args:
        frequency: omega_n of the posture, in rad/s.
        rest: Desired configuration, shape (nq,), in rad.
    """

    def __init__(self, frequency: float, rest: FloatArray) -> None:
        self.parameters = PostureParameters(*second_order(frequency, 1.0), rest, np.zeros((0, 0)))

    def acceleration_and_torque(
        self, backend: Backend, parameters: PostureParameters, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return the joint acceleration in the null space of the tip task, and None; see Posture."""
        return null_space_projection(backend, J, posture_pd(parameters, q, dq)), None


def posture_pd(parameters: PostureParameters, q: Array, dq: Array) -> Array:
    """Return the joint acceleration towards a configuration, without projection, shape (nq,), in rad/s^2."""
    return np.asarray(parameters.k_p * (parameters.rest - q) - parameters.k_v * dq)


def null_space_projection(backend: Backend, J: Array, ddq: Array) -> Array:
    """Return (1 - J^+ J) ddq, shape (nq,), from shapes (rows, nq) and (nq,); smooth through singular configurations."""
    square = J.dot(J.T)
    square = square + 1e-12 * sum(square[i, i] for i in range(len(square))) * np.eye(len(square))
    return np.asarray(ddq - J.T.dot(backend.solve_symmetric(square, J.dot(ddq), None)))


def _inertia_at_rest(model: RobotModel, rest: FloatArray, first: int) -> FloatArray:
    """Return the inertia of the joints from `first` on with a fixed tip, shape (nq, nq); zero for the others."""
    J = model.tip_jacobian(rest)[:3]

    def held(M: FloatArray) -> FloatArray:
        M_inverse, inertia = np.linalg.pinv(M, hermitian=True), np.zeros(M.shape)
        mobility = M_inverse - M_inverse @ J.T @ np.linalg.pinv(J @ M_inverse @ J.T, hermitian=True) @ J @ M_inverse
        inertia[..., first:, first:] = np.linalg.pinv(mobility[..., first:, first:], hermitian=True)
        return inertia

    return np.asarray(each_run(held, model.mass_matrix(rest)))


class WholeBodyParameters(NamedTuple):
    """The parameters of the whole-body law: those of the tip task and of the posture task."""

    tip: TipParameters
    posture: PostureParameters


class TaskState(NamedTuple):
    """State of the tip task of an arm, along the rows of the task."""

    q: Array  # joint positions of the arm, shape (n,), in rad
    dq: Array  # joint velocities of the arm, shape (n,), in rad/s
    x: Array  # position of the tip in the base frame, shape (3,), in m
    J: Array  # Jacobian, shape (rows, n)
    dJ_dq: Array  # dJ/dt dq, shape (rows,), in m/s^2 and rad/s^2  # noqa: N815 - as in the papers
    M_inverse_J: Array  # M^-1 J^T, shape (n, rows)
    error: Array  # desired less actual position and orientation, shape (rows,), in m and rad
    velocity: Array  # velocity of the tip, shape (rows,), in m/s and rad/s

    @property
    def mobility(self) -> Array:
        """Lambda^-1 = J M^-1 J^T, shape (rows, rows), in 1/kg."""
        return np.asarray(self.J.dot(self.M_inverse_J))


class WholeBody(TorqueLaw[WholeBodyParameters]):
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
        parameters = WholeBodyParameters(self._task.parameters, self._posture.parameters)
        super().__init__([model], config.gravity_compensation, parameters)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        tip, posture = self.parameters
        spare = self.models[0].nq > len(tip.directions)
        return VelocityGain(0.0, max(tip.k_v, posture.k_v) if spare else tip.k_v)

    def evaluate(
        self,
        arms: Arms,
        parameters: WholeBodyParameters,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        state: Array,
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see TorqueLaw."""
        (arm,) = arms
        return self.control(arm, parameters, q, dq, reference), state

    def control(
        self,
        arm: Arm,
        parameters: WholeBodyParameters,
        q: Array,
        dq: Array,
        reference: Array,
        gravity: Array | None = None,
    ) -> Array:
        """Return the torques of the law above; see Arm.inverse_dynamics for gravity, TorqueLaw for the others."""
        task = self.task_state(arm, parameters, q, dq, reference)
        return self.joint_torques(
            arm, parameters, task, self.acceleration(arm, parameters, task, reference), None, gravity
        )

    def task_state(self, arm: Arm, parameters: WholeBodyParameters, q: Array, dq: Array, reference: Array) -> TaskState:
        """Return the state of the tip task; see TorqueLaw for the arguments."""
        tip = arm.tip(q, dq)
        J, dJ_dq = self._task.jacobian(parameters.tip, tip)
        error = self._task.error(arm.backend, parameters.tip, tip, reference)
        M_inverse_J = arm.backend.solve_symmetric(arm.mass_matrix(q), J.T, "the mass matrix is singular")
        return TaskState(q, dq, tip.x, J, dJ_dq, M_inverse_J, error, J.dot(dq))

    def acceleration(self, arm: Arm, parameters: WholeBodyParameters, task: TaskState, reference: Array) -> Array:
        """Return F* of TipTask, shape (rows,), in m/s^2 and rad/s^2."""
        return self._task.acceleration(arm.backend, parameters.tip, task.error, task.velocity, reference)

    def joint_torques(
        self,
        arm: Arm,
        parameters: WholeBodyParameters,
        task: TaskState,
        acceleration: Array,
        force: Array | None = None,
        gravity: Array | None = None,
    ) -> Array:
        r"""Return the torques for an acceleration a and an additional force F of the tip.

        .. math:: \tau = h + J^T (\Lambda (a - \dot J \dot q) + F) + N^T \tau_0

        Args:
            arm: The arm.
            parameters: Parameters of the law.
            task: State of the tip task.
            acceleration: a along the rows of the task, shape (rows,).
            force: F along the rows of the task, shape (rows,), in N; None for no force.
            gravity: See Arm.inverse_dynamics.
        """
        backend, J = arm.backend, task.J
        F = acceleration - task.dJ_dq
        # N^T tau_0 = tau_0 - J^T Lambda J M^-1 tau_0, and tau_0 = M ddq_0 + spring.
        ddq_0, spring = self._posture.acceleration_and_torque(backend, parameters.posture, J, task.q, task.dq)
        F = F - J.dot(ddq_0)
        if spring is not None:
            F = F - task.M_inverse_J.T.dot(spring)
        mobility = self._task.damp(backend, parameters.tip, J, task.error, task.mobility)
        moving = backend.solve_symmetric(mobility, F, "the tip's Jacobian is singular")
        if force is not None:
            moving = moving + force
        torque: Array = arm.inverse_dynamics(task.q, task.dq, ddq_0, gravity) + J.T.dot(moving)
        return torque if spring is None else torque + spring


TAKES_DRAWN = True
CONFIG = WholeBodyConfig


def build(config: WholeBodyConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the single loop of a config; it commands every joint.

    Springs hold the joints of mounted arms at home. If the robot has one stage, the law pulls all joints home.
    """
    joints, first_held = slice(0, robot.model.nq), 0 if len(robot.stages) == 1 else None
    return (Loop("whole", joints, config.period, WholeBody(robot.model, config, robot.home, first_held)),)
