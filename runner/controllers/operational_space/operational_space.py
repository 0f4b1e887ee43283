"""Operational-space control of the tip position or pose."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from pydantic import NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Loop, VelocityGain
from runner.controllers.operational_space.tip_task import TaskName, held_orientation, task_start
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyLaw
from runner.controllers.torque_law import Arm, TorqueLaw
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.robots.task_space import task_basis
from runner.schema.model import StrictModel
from runner.schema.units import RadiansPerSecond, Seconds
from runner.schema.values import NonNegativePerStage, PositivePerStage, by_stage
from runner.symbolic.maths import Array, Scalar


class OperationalSpaceConfig(StrictModel):
    """Config of operational-space control.

    Attributes:
        kind: Registry name of the controller.
        task: Whether the tip's position is led, or its pose, with home's orientation held.
        natural_frequency: omega_n of the closed loop in every direction of the tip, in rad/s.
        damping_ratio: xi of the closed loop.
        period: Time between two ticks, in s.
        gravity_compensation: Whether the law holds the gravity term p(x).
        feedforward: Whether the law follows the desired velocity and acceleration, or sees a moving goal.
        singularity_damping: Share of the tip's error by which the inverse of J is damped near a singular posture;
            0 is the law as printed.
        null_space_frequency: omega_n of the posture task, home, of an arm with more joints than the task needs, in
            rad/s.
    """

    kind: Literal["operational_space"]
    task: TaskName
    natural_frequency: RadiansPerSecond[PositivePerStage]
    damping_ratio: PositivePerStage
    period: Seconds[PositivePerStage]
    gravity_compensation: bool
    feedforward: bool
    singularity_damping: NonNegativeFloat
    null_space_frequency: RadiansPerSecond[NonNegativePerStage]


class OperationalSpaceNumbers(NamedTuple):
    """The numbers of operational-space control.

    Attributes:
        weights: Of desired position, velocity and acceleration in F*, shape (3,).
        k_p: omega_n^2, shape (3,), in 1/s^2: NumPy multiplies arrays quicker than a float.
        k_v: 2 xi omega_n, shape (3,), in 1/s.
        damping: Square of the share of the tip's error by which the inverse of J is damped.
        singular_below: Singular value below which it is, in m.
    """

    weights: Array
    k_p: Array
    k_v: Array
    damping: Scalar
    singular_below: Scalar


class OperationalSpace(TorqueLaw[OperationalSpaceNumbers]):
    r"""Dynamic decoupling and linear control of the tip position of an arm with three joints.

    The thesis writes the law in operational space, eq. (3.32) with (3.40):

    .. math::

        \tau = J^T (\hat\Lambda F^* + \hat\mu + \hat p), \qquad
        F^* = \ddot x_d - k_v (\dot x - \dot x_d) - k_p (x - x_d)

    With a square, regular J this is the joint-space law

    .. math:: \tau = M J^{-1} (F^* - \dot J \dot q) + V + G,

    inverse dynamics at the joint acceleration J^-1 (F* - dJ/dt dq), which is how it is computed: one linear solve,
    no inverse. Without feedforward the desired velocity and acceleration are taken as zero, which is the goal law,
    eq. (3.33). Without gravity compensation the term p (that is G) is left out.

    The law has no answer at a singular posture, and sampled control no finite one beside it: an unlimited goal
    move of the Macro passes the base axis within a tick and diverges. So where J is nearly singular its inverse is
    damped (Levenberg-Marquardt): J^T (J J^T + lambda^2 I)^-1 with lambda = singularity_damping |x_d - x|, faded in as
    the smallest singular value falls below a tenth of the reach. It vanishes with the error, so that neither rest
    nor close tracking is touched.

    Args:
        model: The robot; only its URDF-derived constants are read.
        law: The law's numbers; k_p = omega_n^2 (3.37), k_v = 2 xi omega_n (3.38). It has no null space, and its tip
            speed no limit.

    Raises:
        ConfigError: if the arm has another number of joints than three.
    """

    def __init__(self, model: RobotModel, law: WholeBodyLaw) -> None:
        if model.nq != 3:
            raise ConfigError(
                f"controller.kind: operational_space needs a square Jacobian of the tip position, 3 joints; "
                f"the arm has {model.nq} ({', '.join(model.joint_names)})"
            )
        k_p, k_v = law.natural_frequency**2, 2.0 * law.damping_ratio * law.natural_frequency
        weights = np.array([k_p, k_v, 1.0]) if law.feedforward else np.array([k_p, 0.0, 0.0])
        self._damped = law.singularity_damping > 0.0
        numbers = OperationalSpaceNumbers(
            weights, np.full(3, k_p), np.full(3, k_v), law.singularity_damping**2, 0.1 * model.reach
        )
        super().__init__([model], law.gravity_compensation, numbers)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(0.0, float(self.numbers.k_v[0]))

    def evaluate(
        self,
        arms: Sequence[Arm],
        numbers: OperationalSpaceNumbers,
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
        numbers: OperationalSpaceNumbers,
        q: Array,
        dq: Array,
        reference: Array,
        gravity: Array | None = None,
    ) -> Array:
        """Return the torques of the law above; see Arm.inverse_dynamics for gravity, TorqueLaw for the others."""
        backend, tip = arm.backend, arm.tip(q, dq)
        J = tip.J[:3]
        F = numbers.weights.dot(reference) - numbers.k_p * tip.x - numbers.k_v * J.dot(dq) - tip.dJ_dq[:3]
        solution, determinant = backend.solve_three(J, F, None if self._damped else "the tip's Jacobian is singular")
        if self._damped:
            # |det J| over the other two singular values' largest possible product: a lower bound of the smallest.
            entries = J.ravel()
            nearness = 2.0 * backend.absolute(determinant) / (entries.dot(entries) * numbers.singular_below)

            def damped() -> Array:
                error = reference[0] - tip.x
                added = numbers.damping * error.dot(error) * (1.0 - nearness * nearness)
                square = J.dot(J.T) + added * np.eye(3)
                return np.asarray(J.T.dot(backend.solve_symmetric(square, F, "the tip's Jacobian is singular")))

            solution = backend.choose(backend.less(nearness, 1.0), damped, lambda: solution)
        return arm.inverse_dynamics(q, dq, solution, gravity)


def tip_law(
    model: RobotModel, numbers: WholeBodyLaw, home: FloatArray, orientation: FloatArray | None = None
) -> OperationalSpace | WholeBody:
    """Return the law that leads an arm's tip, whatever its number of joints.

    Three joints that can bring the tip in every direction lead it by OperationalSpace. Others do by WholeBody, whose
    null space draws all joints to spare home; without that an arm drifts into its joint stops.

    Args:
        model: The arm.
        numbers: The law's numbers.
        home: Joint positions at home, shape (nq,), in rad.
        orientation: The orientation that the tip holds, in the base frame, shape (3, 3); None leads its position alone.

    Raises:
        ConfigError: if the arm has fewer joints than the tip has directions to go.
    """
    if model.nq == 3 == len(task_basis(model, pose=False)) and orientation is None:
        return OperationalSpace(model, numbers)
    return WholeBody(model, numbers, home, first_held=0, orientation=orientation)


CONFIG = OperationalSpaceConfig


def build(config: OperationalSpaceConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the single loop of a config; it commands every joint.

    Raises:
        ConfigError: if the robot has several stages, or its arm fewer joints than the task has dimensions.
    """
    names = robot.stage_names
    if len(names) > 1:
        raise ConfigError(
            f"controller.kind: operational_space controls one arm; the robot has {robot.model.nq} joints in "
            f"stages ({', '.join(names)}); take macro_mini or whole_body"
        )
    orientation = held_orientation(config.task, robot.model, robot.home)
    (natural_frequency,) = by_stage("controller.natural_frequency", config.natural_frequency, names)
    (damping_ratio,) = by_stage("controller.damping_ratio", config.damping_ratio, names)
    (period,) = by_stage("controller.period", config.period, names)
    (null_space_frequency,) = by_stage("controller.null_space_frequency", config.null_space_frequency, names)
    numbers = WholeBodyLaw(
        natural_frequency=natural_frequency,
        damping_ratio=damping_ratio,
        gravity_compensation=config.gravity_compensation,
        feedforward=config.feedforward,
        null_space_frequency=null_space_frequency,
        max_tip_speed=None,
        singularity_damping=config.singularity_damping,
    )
    controller = tip_law(robot.model, numbers, robot.home, orientation)
    return (Loop(names[0], slice(0, robot.model.nq), period, controller),)


def start_posture(config: OperationalSpaceConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return where the arm stands at a trajectory's start: for a pose, with home's orientation."""
    return task_start(config.task, robot, start)
