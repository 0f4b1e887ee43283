"""PD control of flexible-joint motors, with gravity compensation at the desired configuration."""

from typing import Literal, NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import DesiredJoints, JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.torque_law import Arm, second_order
from runner.robots.model import RobotModel
from runner.schema.units import RotaryStiffness
from runner.schema.values import PositivePerJoint, expand
from runner.symbolic.maths import Array, Scalar


class MotorPdConfig(JointLawConfig):
    """Config of PD control of flexible-joint motors.

    Attributes:
        kind: Registry name of the controller.
        natural_frequency: omega_n of each rigid joint without coupling, and of the tip motion, in rad/s.
        joint_stiffness: Nominal stiffness K of the joint springs, in N m/rad; one for all joints or a list with one for
            each.
    """

    kind: Literal["motor_pd"]
    joint_stiffness: RotaryStiffness[PositivePerJoint]


class MotorPdParameters(NamedTuple):
    """The parameters of PD control of motors."""

    k_p: Scalar  # omega_n^2, in 1/s^2
    k_v: Scalar  # 2 xi omega_n, in 1/s
    inertia: Array  # diagonal of M + B at home, shape (nq,), in kg m^2
    compliance: Array  # K^-1 of each joint, shape (nq,), in rad/(N m)


class MotorPd(JointLaw[MotorPdParameters, MotorPdConfig]):
    r"""PD control of motors with gravity (Tomei, IEEE Transactions on Automatic Control 36(10), 1991).

    .. math:: \tau = D (\omega_n^2 (\theta_d - \theta) + 2 \xi \omega_n (\dot q_d - \dot\theta)) + G(q_d), \qquad
        \theta_d = q_d + K^{-1} G(q_d)

    with D = diag(M + B) at home. At rest the links are exactly at q_d if the nominal K and G are exact. The arm reaches
    this rest from any start if K is larger than the gradient of G. The law uses only theta: the encoders are on the
    motors, and their readings are not corrected.
    """

    def choose_parameters(self, model: RobotModel, config: MotorPdConfig, inertia: FloatArray) -> MotorPdParameters:
        """Return the parameters of the law above; see JointLaw."""
        gains = second_order(config.natural_frequency, config.damping_ratio)
        stiffness = expand("controller.joint_stiffness", config.joint_stiffness, model.joint_names)
        return MotorPdParameters(*gains, inertia, 1.0 / np.array(stiffness))

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(self.parameters.own.k_v, 0.0, True)

    def command(
        self, arm: Arm, parameters: MotorPdParameters, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see JointLaw."""
        rest = np.zeros(len(q))
        weight = arm.inverse_dynamics(desired.q, rest, rest)
        off = desired.q + parameters.compliance * weight - q
        return parameters.inertia * (parameters.k_p * off + parameters.k_v * (desired.dq - dq)) + weight, state


CONFIG = MotorPdConfig
FOLLOWS_JOINTS = True
build = joint_law_builder(MotorPd)
