"""Operational-space control of the tip position or pose."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Loop, VelocityGain
from runner.controllers.operational_space.tip_task import TaskName, held_orientation, task_start
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyLaw
from runner.controllers.torque_law import Arm, Arms, TorqueLaw, second_order
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
        task: Controlled tip motion: the position, or the pose with the orientation of home.
        natural_frequency: omega_n of the closed loop in every direction of the tip, in rad/s.
        damping_ratio: xi of the closed loop.
        period: Time between two ticks, in s.
        gravity_compensation: True if the law includes the gravity term p(x).
        feedforward: True if the law uses the desired velocity and acceleration; False to follow a moving goal.
        singularity_damping: Damping of the inverse of J near a singular configuration, as a fraction of the tip error;
            0 for the law in the thesis.
        null_space_frequency: omega_n of the posture task to home if the arm has redundant joints, in rad/s.
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


class OperationalSpaceParameters(NamedTuple):
    """The parameters of operational-space control."""

    weights: Array  # weights of desired position, velocity and acceleration in F*, shape (3,)
    k_p: Array  # omega_n^2, shape (3,), in 1/s^2, because NumPy multiplies arrays faster than an array and a float
    k_v: Array  # 2 xi omega_n, shape (3,), in 1/s
    damping: Scalar  # singularity_damping^2
    singular_below: Scalar  # singular value below which the inverse of J is damped, in m


class OperationalSpace(TorqueLaw[OperationalSpaceParameters]):
    r"""Dynamic decoupling and linear control of the tip position of an arm with three joints.

    The thesis writes the law in operational space, eq. (3.32) with (3.40):

    .. math::

        \tau = J^T (\hat\Lambda F^* + \hat\mu + \hat p), \qquad
        F^* = \ddot x_d - k_v (\dot x - \dot x_d) - k_p (x - x_d)

    With a square, regular J this is the joint-space law

    .. math:: \tau = M J^{-1} (F^* - \dot J \dot q) + V + G,

    inverse dynamics at the joint acceleration J^-1 (F* - dJ/dt dq). The code computes this form with one linear solve.
    Without feedforward the desired velocity and acceleration are zero, which is the goal law, eq. (3.33). Without
    gravity compensation the law omits p (that is G).

    The law has no solution at a singular configuration. Sampled control diverges near one: in an unlimited goal move
    the Macro passes the base axis within a tick. So the inverse of a nearly singular J is damped (Levenberg-Marquardt):
    J^T (J J^T + lambda^2 I)^-1 with lambda = singularity_damping |x_d - x|. The damping fades in as the smallest
    singular value falls below a tenth of the reach. It vanishes with the error, so it does not change rest or close
    tracking.

    Args:
        model: The robot; the law reads only its URDF-derived constants.
        law: Config of the law; k_p = omega_n^2 (3.37), k_v = 2 xi omega_n (3.38). The null-space frequency and the
            maximum tip speed are ignored.

    Raises:
        ConfigError: if the arm does not have three joints.
    """

    def __init__(self, model: RobotModel, law: WholeBodyLaw) -> None:
        if model.nq != 3:
            raise ConfigError(
                f"controller.kind: operational_space needs a square Jacobian of the tip position, 3 joints; "
                f"the arm has {model.nq} ({', '.join(model.joint_names)})"
            )
        k_p, k_v = second_order(law.natural_frequency, law.damping_ratio)
        weights = np.array([k_p, k_v, 1.0]) if law.feedforward else np.array([k_p, 0.0, 0.0])
        self._damped = law.singularity_damping > 0.0
        parameters = OperationalSpaceParameters(
            weights, np.full(3, k_p), np.full(3, k_v), law.singularity_damping**2, 0.1 * model.reach
        )
        super().__init__([model], law.gravity_compensation, parameters)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(0.0, float(self.parameters.k_v[0]))

    def evaluate(
        self,
        arms: Arms,
        parameters: OperationalSpaceParameters,
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
        parameters: OperationalSpaceParameters,
        q: Array,
        dq: Array,
        reference: Array,
        gravity: Array | None = None,
    ) -> Array:
        """Return the torques of the law above; see Arm.inverse_dynamics for gravity, TorqueLaw for the others."""
        backend, tip = arm.backend, arm.tip(q, dq)
        J = tip.J[:3]
        F = parameters.weights.dot(reference) - parameters.k_p * tip.x - parameters.k_v * J.dot(dq) - tip.dJ_dq[:3]
        solution, determinant = backend.solve_three(J, F, None if self._damped else "the tip's Jacobian is singular")
        if self._damped:
            # |det J| over the largest possible product of the other two singular values: a lower bound of the smallest.
            entries = J.ravel()
            nearness = 2.0 * backend.absolute(determinant) / (entries.dot(entries) * parameters.singular_below)

            def damped() -> Array:
                error = reference[0] - tip.x
                added = parameters.damping * error.dot(error) * (1.0 - nearness * nearness)
                square = J.dot(J.T) + added * np.eye(3)
                return np.asarray(J.T.dot(backend.solve_symmetric(square, F, "the tip's Jacobian is singular")))

            solution = backend.choose(backend.less(nearness, 1.0), damped, lambda: solution)
        return arm.inverse_dynamics(q, dq, solution, gravity)


def tip_law(
    model: RobotModel, law: WholeBodyLaw, home: FloatArray, orientation: FloatArray | None = None
) -> OperationalSpace | WholeBody:
    """Return the tip control law of an arm with any number of joints.

    OperationalSpace controls the position of an arm with three joints if its tip can move in every direction. WholeBody
    controls all others. Its null space pulls redundant joints home, because they would drift into their stops.

    Args:
        model: The arm.
        law: Config of the law.
        home: Joint positions at home, shape (nq,), in rad.
        orientation: Desired orientation of the tip in the base frame, shape (3, 3); None for position control.

    Raises:
        ConfigError: if the arm has fewer joints than the tip has directions of motion.
    """
    if model.nq == 3 == len(task_basis(model, pose=False)) and orientation is None:
        return OperationalSpace(model, law)
    return WholeBody(model, law, home, first_held=0, orientation=orientation)


TAKES_DRAWN = True
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
    (period,) = by_stage("controller.period", config.period, names)
    law = WholeBodyLaw.of_stage(config, names, 0)
    controller = tip_law(robot.model, law, robot.home, orientation)
    return (Loop(names[0], slice(0, robot.model.nq), period, controller),)


def start_posture(config: OperationalSpaceConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return the joint positions at the start; see task_start."""
    return task_start(config.task, robot, start)
