"""Passivity-based joint control without adaptation."""

from typing import Literal, NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import DesiredJoints, JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.torque_law import Arm
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class PassivityConfig(JointLawConfig):
    """Config of passivity-based joint control.

    Attributes:
        kind: Registry name of the controller.
        natural_frequency: lambda, K_D / diag M, and omega_n of the tip motion, in rad/s.
        damping_ratio: xi of the tip motion; the joints have two equal poles.
    """

    kind: Literal["passivity"]


class PassivityParameters(NamedTuple):
    """The parameters of passivity-based control."""

    rate: Scalar  # lambda, in 1/s
    damping: Array  # diagonal of K_D, shape (nq,), in kg m^2/s


class Passivity(JointLaw[PassivityParameters, PassivityConfig]):
    r"""Passivity-based control (Slotine and Li, International Journal of Robotics Research 6(3), 1987), not adaptive.

    .. math::

        \tau = M \ddot q_r + C \dot q_r + G + K_D s, \qquad \dot q_r = \dot q_d + \lambda (q_d - q), \qquad
        s = \dot q_r - \dot q

    with lambda = omega_n and K_D = omega_n diag M(home). With an exact model M ds/dt + (C + K_D) s = 0, so s^T M s / 2
    changes at the rate -s^T K_D s. The law does not cancel the arm's dynamics. It is stable in continuous time for any
    K_D > 0. At rest, a wrong gravity term G_n causes the error (G - G_n) / (lambda K_D), as under PD control.
    """

    def choose_parameters(self, model: RobotModel, config: PassivityConfig, inertia: FloatArray) -> PassivityParameters:
        """Return the parameters of the law above; see JointLaw."""
        return PassivityParameters(config.natural_frequency, config.natural_frequency * inertia)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(self.parameters.own.rate, self.parameters.own.rate)

    def command(
        self, arm: Arm, parameters: PassivityParameters, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see JointLaw."""
        dq_r, ddq_r = desired.reference(parameters.rate, q, dq)
        return parameters.damping * (dq_r - dq) + passive_dynamics(arm, q, dq, dq_r, ddq_r), state


def passive_dynamics(arm: Arm, q: Array, dq: Array, dq_r: Array, ddq_r: Array) -> Array:
    r"""Return M ddq_r + C dq_r + G, shape (nq,), in N m, with the C of Christoffel's symbols.

    V(dq) = C(dq) dq is quadratic in the velocities, so C(dq) dq_r = V((dq + dq_r) / 2) - V((dq - dq_r) / 2).
    """
    weightless = arm.inverse_dynamics(q, 0.5 * (dq - dq_r), np.zeros(len(q)), np.zeros(3))
    less = -1.0 * weightless  # before the next call overwrites it
    return less + arm.inverse_dynamics(q, 0.5 * (dq + dq_r), ddq_r)


CONFIG = PassivityConfig
FOLLOWS_JOINTS = True
TAKES_DRAWN = True
build = joint_law_builder(Passivity)
