"""Base classes and builder of joint-space control laws, and their desired joint motion from the tip motion."""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, Self, TypeVar

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Controller, Loop
from runner.controllers.operational_space.tip_task import TaskName, TipParameters, TipTask, held_orientation, task_start
from runner.controllers.operational_space.whole_body import PostureParameters, PostureTask, posture_pd
from runner.controllers.torque_law import Arm, Arms, TorqueLaw, structure_of
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import RadiansPerSecond, Seconds
from runner.symbolic.maths import Array, Scalar


class JointLawConfig(StrictModel):
    """Config of every joint-space law.

    Attributes:
        task: Controlled tip motion: the position, or the pose with the orientation of home.
        natural_frequency: omega_n of the joints, which sets every gain of the law, and of the tip motion, in rad/s.
        damping_ratio: xi of the joints and of the tip motion.
        period: Time between two ticks, in s.
        gravity_compensation: True if the law includes the gravity term.
        feedforward: True if the law uses the desired velocity and acceleration; False to follow a moving goal.
        singularity_damping: Damping of the inverse of J near a singular configuration, as a fraction of the tip error;
            0 for no damping.
        null_space_frequency: omega_n of the posture task to home if the arm has redundant joints, in rad/s.
    """

    task: TaskName
    natural_frequency: RadiansPerSecond[PositiveFloat]
    damping_ratio: PositiveFloat
    period: Seconds[PositiveFloat]
    gravity_compensation: bool
    feedforward: bool
    singularity_damping: NonNegativeFloat
    null_space_frequency: RadiansPerSecond[NonNegativeFloat]


class JointMotionParameters(NamedTuple):
    """The parameters of a joint motion."""

    tip: TipParameters
    posture: PostureParameters
    period: Scalar  # time between two ticks, in s


class DesiredJoints(NamedTuple):
    """The desired state of the joints at a tick."""

    q: Array  # positions, shape (nq,), in rad
    dq: Array  # velocities, shape (nq,), in rad/s
    ddq: Array  # accelerations, shape (nq,), in rad/s^2
    period: Scalar  # time between two ticks, in s

    def reference(self, rate: Scalar, q: Array, dq: Array) -> tuple[Array, Array]:
        """Return dq_r = dq_d + lambda (q_d - q) and its derivative ddq_r, for a rate lambda, in 1/s."""
        return self.dq + rate * (self.q - q), self.ddq + rate * (self.dq - dq)


class JointMotion:
    r"""Desired joint positions, velocities and accelerations at each tick.

    A desired joint motion is used directly, without feedforward only its positions. A desired tip motion is the motion
    of a virtual arm whose tip obeys F* of TipTask (resolved acceleration; Luh, Walker and Paul, IEEE Transactions on
    Automatic Control 25(3), 1980):

    .. math::

        \ddot q_d = \ddot q_0 + J^+ (F^* - \dot J \dot q_d - J \ddot q_0), \qquad
        \ddot q_0 = -2 \omega_{n0} \dot q_d - \omega_{n0}^2 (q_d - q_\mathrm{rest})

    J, dJ/dt and F* are taken at q_d, which starts at the measured positions of the first tick. The acceleration is
    constant over each period. The virtual arm has no inertia, limits or noise, so disturbances of the real arm do not
    change q_d. Near a singular configuration the inverse is damped as in the tip laws: J^T (J J^T + lambda^2)^-1.

    Args:
        model: The arm.
        config: Config of the law.
        rest: Configuration of the posture task, shape (nq,), in rad.
        joints: True if the desired motion is a joint motion.

    Raises:
        ConfigError: if the desired motion is one of the tip and the arm has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: JointLawConfig, rest: FloatArray, joints: bool) -> None:
        self._joints, self._feedforward = joints, config.feedforward
        # A joint motion needs no task, which an arm of two joints may lack.
        self._task = TipTask(model, None if joints else held_orientation(config.task, model, rest), config)
        posture = PostureTask(config.null_space_frequency, rest).parameters
        self.parameters = JointMotionParameters(self._task.parameters, posture, config.period)

    def structure(self) -> dict[str, Any]:
        """Return the attributes without the parameters; see TorqueLaw.structure."""
        return structure_of(self)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the state at the first tick: q_d and dq_d, shape (2 nq,); empty for a joint motion."""
        return np.zeros(0) if self._joints else np.concatenate([q, np.zeros(len(q))])

    def follow(
        self, arm: Arm, parameters: JointMotionParameters, reference: Array, state: Array
    ) -> tuple[DesiredJoints, Array]:
        """Return the desired joints and the state for the next tick."""
        if self._joints:
            q_d, dq_d, ddq_d = reference[0], reference[1], reference[2]
            if self._feedforward:
                return DesiredJoints(q_d, dq_d, ddq_d, parameters.period), state
            return DesiredJoints(q_d, 0.0 * dq_d, 0.0 * ddq_d, parameters.period), state
        h, n = parameters.period, len(state) // 2
        q_d, dq_d = state[:n], state[n:]
        ddq_d = self._resolved_acceleration(arm, parameters, q_d, dq_d, reference)
        goes_on = np.concatenate([q_d + h * dq_d + 0.5 * h**2 * ddq_d, dq_d + h * ddq_d])
        return DesiredJoints(q_d, dq_d, ddq_d, h), goes_on

    def _resolved_acceleration(
        self, arm: Arm, parameters: JointMotionParameters, q_d: Array, dq_d: Array, reference: Array
    ) -> Array:
        backend, task, tip = arm.backend, self._task, arm.tip(q_d, dq_d)
        J, dJ_dq = task.jacobian(parameters.tip, tip)
        error = task.error(backend, parameters.tip, tip, reference)
        ddq_0 = posture_pd(parameters.posture, q_d, dq_d)
        F = task.acceleration(backend, parameters.tip, error, J.dot(dq_d), reference) - dJ_dq - J.dot(ddq_0)
        square = task.damp(backend, parameters.tip, J, error, J.dot(J.T))
        return np.asarray(ddq_0 + J.T.dot(backend.solve_symmetric(square, F, "the tip's Jacobian is singular")))


N = TypeVar("N", bound=Any)  # a NamedTuple
C = TypeVar("C", bound=JointLawConfig)


class JointParameters(NamedTuple, Generic[N]):
    """The parameters of a joint-space law: those of the desired motion, and the law's own."""

    motion: JointMotionParameters
    own: N


class JointLaw(TorqueLaw[JointParameters[N]], Generic[N, C]):
    """A torque law that follows the desired joints of a JointMotion.

    Args:
        model: The arm.
        config: Config of the law.
        rest: Home, for the posture task and for inertias that are computed once, shape (nq,), in rad.
        joints: True if the desired motion is a joint motion; see JointMotion.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions, or a list has the wrong length.
    """

    def __init__(self, model: RobotModel, config: C, rest: FloatArray, joints: bool = False) -> None:
        self._motion, self._state_size = JointMotion(model, config, rest, joints), 0
        inertia = model.mass_matrix(rest).diagonal().copy()
        parameters = JointParameters(self._motion.parameters, self.choose_parameters(model, config, inertia))
        super().__init__([model], config.gravity_compensation, parameters)

    @abstractmethod
    def choose_parameters(self, model: RobotModel, config: C, inertia: FloatArray) -> N:
        """Return the law's own parameters.

        This also sets the attributes that select the equations, and `_state_size`, the size of the law's own state.

        Args:
            model: The arm.
            config: Config of the law.
            inertia: D = diag M(home), shape (nq,), in kg m^2.
        """

    def with_limits(self, limits: FloatArray) -> Self:
        """Return the law with its torque limits set, if its own parameters have `limits`; see ControlLaw."""
        own = self.parameters.own
        return self.with_parameters(own=own._replace(limits=limits)) if "limits" in own._fields else self

    def start(self, q: FloatArray) -> FloatArray:
        """Return the states of the joint motion and of the law at the first tick; see TorqueLaw."""
        return np.concatenate([self._motion.start(q), self.own_start()])

    def own_start(self) -> FloatArray:
        """Return the law's own state at the first tick, shape (state_size,); zero by default."""
        return np.zeros(self._state_size)

    def evaluate(
        self,
        arms: Arms,
        parameters: JointParameters[N],
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        state: Array,
    ) -> tuple[Array, Array]:
        """Return the torques, and the states of the joint motion and of the law; see TorqueLaw."""
        (arm,) = arms
        own = len(state) - self._state_size
        desired, goes_on = self._motion.follow(arm, parameters.motion, reference, state[:own])
        torque, kept = self.command(arm, parameters.own, q, dq, desired, state[own:])
        return torque, np.concatenate([goes_on, kept])

    @abstractmethod
    def command(
        self, arm: Arm, parameters: N, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques, shape (nq,), in N m, and the law's own state for the next tick.

        Args:
            arm: Nominal arm.
            parameters: The law's own parameters.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            desired: Desired joint motion.
            state: The law's own state, shape (state_size,).
        """


def joint_law_builder(
    law: Callable[[RobotModel, C, FloatArray, bool], Controller],
) -> Callable[..., tuple[Loop, ...]]:
    """Return the `build` of a module from its law, a function of (arm, config, home, joints)."""

    def build(config: C, robot: Robot, joints: bool = False) -> tuple[Loop, ...]:
        """Build the single loop of a config; it commands every joint.

        Raises:
            ConfigError: see the law.
        """
        made = law(robot.model, config, robot.home, joints)
        return (Loop("whole", slice(0, robot.model.nq), config.period, made, follows_joints=joints),)

    return build


def start_posture(config: JointLawConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return the joint positions at the start; see task_start."""
    return task_start(config.task, robot, start)
