"""PD control of each joint with gravity compensation."""

from typing import Literal, NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.joint_space.joint_motion import DesiredJoints, JointMotionNumbers
from runner.controllers.torque_law import Arm
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class JointPdConfig(JointLawConfig):
    """Config of PD control of each joint, with gravity.

    Attributes:
        kind: Its name in the registry.
        natural_frequency: omega_n of every joint that no other moves, and of the motion that leads the tip, in rad/s.
        inertia: Whether gains are scaled by the joints' inertias at home, once, or at every measured posture.
    """

    kind: Literal["joint_pd"]
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


class JointPd(JointLaw[JointPdNumbers, JointPdConfig]):
    r"""PD control with gravity (Takegaki and Arimoto, ASME Journal of Dynamic Systems 103(2), 1981).

    .. math:: \tau = D (\omega_n^2 (q_d - q) + 2 \xi \omega_n (\dot q_d - \dot q)) + G(q), \qquad D = \mathrm{diag} M

    It needs no more of the model than G and one inertia for each joint. At rest a wrong gravity term leaves the sag
    (G - G_believed) / (D omega_n^2); on the way M and V that it leaves out are an error, too. Held for a period h, and
    with D the inertias at the posture, it is stable at rest about that posture for

    .. math:: \omega_n h \lambda_\max(M^{-1} D) < 1 \quad (\xi = 1)

    nearly, because the fastest mode is then its velocity loop: d(v)/dt = -2 omega_n lambda v, sampled.
    """

    def choose_numbers(
        self, model: RobotModel, config: JointPdConfig, rest: FloatArray, motion: JointMotionNumbers
    ) -> JointPdNumbers:
        """Return the numbers of the law above; see JointLaw."""
        self._at_home = config.inertia == "home"
        return JointPdNumbers(
            motion=motion,
            k_p=config.natural_frequency**2,
            k_v=2.0 * config.damping_ratio * config.natural_frequency,
            inertia=model.mass_matrix(rest).diagonal().copy(),
        )

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(self.numbers.k_v, 0.0, self._at_home)

    def command(
        self, arm: Arm, numbers: JointPdNumbers, q: Array, dq: Array, desired: DesiredJoints, memory: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see JointLaw."""
        ddq = numbers.k_p * (desired.q - q) + numbers.k_v * (desired.dq - dq)
        inertia = numbers.inertia if self._at_home else arm.mass_matrix(q).diagonal()
        torque = inertia * ddq  # before the arm is asked again
        rest = np.zeros(len(q))
        return torque + arm.inverse_dynamics(q, rest, rest), memory


CONFIG = JointPdConfig
FOLLOWS_JOINTS = True
build = joint_law_builder(JointPd)
