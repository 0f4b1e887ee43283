"""PID control of each joint with gravity compensation."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import DesiredJoints, JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.torque_law import Arm, second_order
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class JointPidConfig(JointLawConfig):
    """Config of joint PID control with gravity compensation.

    Attributes:
        kind: Registry name of the controller.
        natural_frequency: omega_n of each joint without coupling, and of the tip motion, in rad/s.
        integral_share: k_i / omega_n^3; stable below 2 xi.
        anti_windup: True if the integral of a joint stops while its torque is beyond the limit and the error would
            increase the torque.
    """

    kind: Literal["joint_pid"]
    integral_share: PositiveFloat
    anti_windup: bool


class JointPidParameters(NamedTuple):
    """The parameters of joint PID control."""

    k_p: Scalar  # omega_n^2, in 1/s^2
    k_v: Scalar  # 2 xi omega_n, in 1/s
    k_i: Scalar  # integral_share omega_n^3, in 1/s^3
    inertia: Array  # diagonal of M at home, shape (nq,), in kg m^2
    limits: Array  # torque limits, shape (nq,), in N m; infinite if there is none


class JointPid(JointLaw[JointPidParameters, JointPidConfig]):
    r"""PID control with gravity (Arimoto and Miyazaki, First International Symposium of Robotics Research, 1984).

    .. math::

        \tau = D (\omega_n^2 e + 2 \xi \omega_n \dot e + \kappa \omega_n^3 z) + G(q), \qquad e = q_d - q, \qquad
        z_{k+1} = z_k + h e_k, \qquad D = \mathrm{diag} M

    The characteristic polynomial of a joint without coupling is s^3 + 2 xi omega_n s^2 + omega_n^2 s + kappa omega_n^3,
    stable for kappa < 2 xi (Hurwitz). At rest, z removes the error that a wrong gravity term, a constant load or dry
    friction causes under PD control. With conditional integration (Astrom and Rundqwist, American Control Conference,
    1989), z_k stays constant while the joint's torque is beyond its limit and e has the sign of the torque.
    """

    def choose_parameters(self, model: RobotModel, config: JointPidConfig, inertia: FloatArray) -> JointPidParameters:
        """Return the parameters of the law above; see JointLaw."""
        self._anti_windup, self._state_size = config.anti_windup, model.nq
        gains = second_order(config.natural_frequency, config.damping_ratio)
        k_i = config.integral_share * config.natural_frequency * gains[0]
        return JointPidParameters(*gains, k_i, inertia, model.effort_limits)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(self.parameters.own.k_v, 0.0)

    def command(
        self, arm: Arm, parameters: JointPidParameters, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above, and the integral at the next tick; see JointLaw."""
        error, rest = desired.q - q, np.zeros(len(q))
        ddq = parameters.k_p * error + parameters.k_v * (desired.dq - dq) + parameters.k_i * state
        torque = parameters.inertia * ddq + arm.inverse_dynamics(q, rest, rest)
        step = desired.period * error
        if self._anti_windup:
            step = np.concatenate([_useful(arm, *of) for of in zip(torque, parameters.limits, step, strict=True)])
        return torque, state + step


def _useful(arm: Arm, torque: Scalar, limit: Scalar, step: Scalar) -> Array:
    """Return the increment of a joint's integral, shape (1,): 0 if it would raise a torque beyond the limit."""
    within = arm.backend.less(arm.backend.absolute(torque), limit)
    back = arm.backend.less(torque * step, 0.0)
    return arm.backend.choose(arm.backend.any_of(within, back), lambda: np.array([step]), lambda: np.zeros(1))


CONFIG = JointPidConfig
FOLLOWS_JOINTS = True
TAKES_DRAWN = True
build = joint_law_builder(JointPid)
