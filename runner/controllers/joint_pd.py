"""Proportional and derivative control of each joint, with gravity."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.controllers.controller import FloatArray, Loop
from runner.controllers.joint_motion import JointMotion, JointMotionNumbers
from runner.controllers.maths import Array, Scalar
from runner.controllers.tip_task import TaskName, task_start
from runner.controllers.torque_law import Arm, TorqueLaw
from runner.registry import StrictModel
from runner.robots.model import RobotModel
from runner.robots.robot import Robot


class JointPdConfig(StrictModel):
    """Config of PD control of each joint, with gravity.

    Attributes:
        kind: Its name in the registry.
        task: Whether the tip's position is led, or its pose, with home's orientation held.
        natural_frequency: omega_n of every joint that no other moves, and of the motion that leads the tip, in rad/s.
        damping_ratio: xi of both.
        period: Time between two ticks, in s.
        gravity_compensation: Whether the law holds the gravity term.
        feedforward: Whether the law follows the desired velocity, or sees a moving goal.
        singularity_damping: Share of the tip's error by which the inverse of J is damped near a singular posture;
            0 is the law without damping.
        null_space_frequency: omega_n of the posture task, home, of an arm with more joints than the task needs, in
            rad/s.
        inertia: Whether gains are scaled by the joints' inertias at home, once, or at every measured posture.
    """

    kind: Literal["joint_pd"]
    task: TaskName
    natural_frequency: PositiveFloat
    damping_ratio: PositiveFloat
    period: PositiveFloat
    gravity_compensation: bool
    feedforward: bool
    singularity_damping: NonNegativeFloat
    null_space_frequency: NonNegativeFloat
    inertia: Literal["home", "posture"]


class JointPdNumbers(NamedTuple):
    """The numbers of PD control of each joint.

    Attributes:
        motion: Of the joint motion that is followed.
        k_p: omega_n^2, in 1/s^2.
        k_v: 2 xi omega_n, in 1/s.
        inertia: Diagonal of M at home, shape (nq,), in kg m^2.
    """

    motion: JointMotionNumbers
    k_p: Scalar
    k_v: Scalar
    inertia: Array


class JointPd(TorqueLaw[JointPdNumbers]):
    r"""PD control with gravity (Takegaki and Arimoto, ASME Journal of Dynamic Systems 103(2), 1981).

    .. math:: \tau = D (\omega_n^2 (q_d - q) + 2 \xi \omega_n (\dot q_d - \dot q)) + G(q), \qquad D = \mathrm{diag} M

    It needs no more of the model than G and one inertia for each joint. At rest a wrong gravity term leaves the sag
    (G - G_believed) / (D omega_n^2); on the way M and V that it leaves out are an error, too. Held for a period h, and
    with D the inertias at the posture, it is stable at rest about that posture for

    .. math:: \omega_n h \lambda_\max(M^{-1} D) < 1 \quad (\xi = 1)

    nearly, because the fastest mode is then its velocity loop: d(v)/dt = -2 omega_n lambda v, sampled.

    Args:
        model: The arm.
        config: The law's numbers.
        rest: Home: posture of the null space and of D, shape (nq,), in rad.
        joints: Whether the desired motion is one of the joints; see JointMotion.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: JointPdConfig, rest: FloatArray, joints: bool = False) -> None:
        self._motion = JointMotion(model, config, rest, joints)
        self._at_home = config.inertia == "home"
        numbers = JointPdNumbers(
            motion=self._motion.numbers,
            k_p=config.natural_frequency**2,
            k_v=2.0 * config.damping_ratio * config.natural_frequency,
            inertia=model.mass_matrix(rest).diagonal().copy(),
        )
        super().__init__([model], config.gravity_compensation, numbers)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the joint motion where it starts; see JointMotion."""
        return self._motion.start(q)

    def evaluate(
        self,
        arms: Sequence[Arm],
        numbers: JointPdNumbers,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        memory: Array,
    ) -> tuple[Array, Array]:
        """Return the torques of the law above, and the joint motion at the next tick; see TorqueLaw."""
        (arm,) = arms
        (q_d, dq_d, _), goes_on = self._motion.follow(arm, numbers.motion, reference, memory)
        ddq = numbers.k_p * (q_d - q) + numbers.k_v * (dq_d - dq)
        inertia = numbers.inertia if self._at_home else arm.mass_matrix(q).diagonal()
        torque = inertia * ddq  # before the arm is asked again
        rest = np.zeros(len(q))
        return torque + arm.inverse_dynamics(q, rest, rest), goes_on


CONFIG = JointPdConfig
FOLLOWS_JOINTS = True


def build(config: JointPdConfig, robot: Robot, joints: bool = False) -> tuple[Loop, ...]:
    """Make the one loop that a config describes; it commands every joint. See FollowsJoints.

    Raises:
        ConfigError: see JointPd.
    """
    law = JointPd(robot.model, config, robot.home, joints)
    return (Loop("whole", slice(0, robot.model.nq), config.period, law, follows_joints=joints),)


def start_posture(config: JointPdConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return where the arm stands at a trajectory's start: for a pose, with home's orientation."""
    return task_start(config.task, robot, start)
