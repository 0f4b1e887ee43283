"""PD control of each joint with gravity compensation."""

from typing import Literal, NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import DesiredJoints, JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.torque_law import Arm, second_order
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class JointPdConfig(JointLawConfig):
    """Config of joint PD control with gravity compensation.

    Attributes:
        kind: Registry name of the controller.
        natural_frequency: omega_n of each joint without coupling, and of the tip motion, in rad/s.
        inertia: Configuration of the joint inertias that scale the gains: home, or the measured one at each tick.
    """

    kind: Literal["joint_pd"]
    inertia: Literal["home", "posture"]


class JointPdParameters(NamedTuple):
    """The parameters of joint PD control."""

    k_p: Scalar  # omega_n^2, in 1/s^2
    k_v: Scalar  # 2 xi omega_n, in 1/s
    inertia: Array  # diagonal of M at home, shape (nq,), in kg m^2


class JointPd(JointLaw[JointPdParameters, JointPdConfig]):
    r"""PD control with gravity (Takegaki and Arimoto, ASME Journal of Dynamic Systems 103(2), 1981).

    .. math:: \tau = D (\omega_n^2 (q_d - q) + 2 \xi \omega_n (\dot q_d - \dot q)) + G(q), \qquad D = \mathrm{diag} M

    The law uses only G and one inertia for each joint. At rest, a wrong gravity term G_n causes the error
    (G - G_n) / (D omega_n^2). In motion, the missing M and V cause a further error. With a period h and D at the
    current configuration, the law is stable at rest approximately for

    .. math:: \omega_n h \lambda_\max(M^{-1} D) < 1 \quad (\xi = 1)

    because the fastest mode is then the sampled velocity loop, d(v)/dt = -2 omega_n lambda v.
    """

    def choose_parameters(self, model: RobotModel, config: JointPdConfig, inertia: FloatArray) -> JointPdParameters:
        """Return the parameters of the law above; see JointLaw."""
        self._at_home = config.inertia == "home"
        return JointPdParameters(*second_order(config.natural_frequency, config.damping_ratio), inertia)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(self.parameters.own.k_v, 0.0, self._at_home)

    def command(
        self, arm: Arm, parameters: JointPdParameters, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see JointLaw."""
        ddq = parameters.k_p * (desired.q - q) + parameters.k_v * (desired.dq - dq)
        inertia = parameters.inertia if self._at_home else arm.mass_matrix(q).diagonal()
        torque = inertia * ddq  # before the next call overwrites it
        rest = np.zeros(len(q))
        return torque + arm.inverse_dynamics(q, rest, rest), state


CONFIG = JointPdConfig
FOLLOWS_JOINTS = True
TAKES_DRAWN = True
build = joint_law_builder(JointPd)
