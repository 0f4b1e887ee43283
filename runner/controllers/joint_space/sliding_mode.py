"""Sliding-mode joint control with a boundary layer."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import DesiredJoints, JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.joint_space.passivity import passive_dynamics
from runner.controllers.torque_law import Arm, clip
from runner.robots.model import RobotModel
from runner.schema.units import RadiansPerSecond
from runner.symbolic.maths import Array, Scalar


class SlidingModeConfig(JointLawConfig):
    """Config of sliding-mode joint control.

    Attributes:
        kind: Registry name of the controller.
        natural_frequency: lambda, K_D / diag M, and omega_n of the tip motion, in rad/s.
        damping_ratio: xi of the tip motion; the joints have two real poles.
        boundary_layer: Half-width phi of the boundary layer of s, in rad/s.
        switching_gain: kappa, the torque K beyond the layer relative to phi omega_n diag M.
    """

    kind: Literal["sliding_mode"]
    boundary_layer: RadiansPerSecond[PositiveFloat]
    switching_gain: PositiveFloat


class SlidingModeParameters(NamedTuple):
    """The parameters of sliding-mode control."""

    rate: Scalar  # lambda, in 1/s
    boundary_layer: Scalar  # phi, in rad/s
    damping: Array  # diagonal of K_D, shape (nq,), in kg m^2/s
    switching_gain: Array  # diagonal of K, shape (nq,), in N m


class SlidingMode(JointLaw[SlidingModeParameters, SlidingModeConfig]):
    r"""Sliding-mode control with a boundary layer (Slotine, International Journal of Control 40(2), 1984).

    This form preserves the arm's passivity (Slotine and Li, Applied Nonlinear Control, 1991, section 9.1):

    .. math::

        \tau = M \ddot q_r + C \dot q_r + G + K_D s + K \, \mathrm{sat}(s / \phi), \qquad
        s = \dot q_r - \dot q = \dot e + \lambda e, \qquad \dot q_r = \dot q_d + \lambda (q_d - q)

    with lambda = omega_n, K_D = omega_n D and K = kappa phi omega_n D, D = diag M(home). At kappa = 1, the balance
    condition of the layer, s decays in the layer twice as fast as e. At rest, an unmodelled torque d of a joint causes
    s = d / (K_D + K / phi) if |d| < K + phi K_D. Then |s| < phi and, because de/dt = s - lambda e, |e| < phi / lambda.
    Outside the layer, s returns if d s < K |s|. Noise and the control period limit the velocity gain K / phi of the
    layer, so phi cannot be arbitrarily small.
    """

    def choose_parameters(
        self, model: RobotModel, config: SlidingModeConfig, inertia: FloatArray
    ) -> SlidingModeParameters:
        """Return the parameters of the law above; see JointLaw."""
        damping = config.natural_frequency * inertia
        return SlidingModeParameters(
            rate=config.natural_frequency,
            boundary_layer=config.boundary_layer,
            damping=damping,
            switching_gain=config.switching_gain * config.boundary_layer * damping,
        )

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v within the layer."""
        own = self.parameters.own
        gain = own.switching_gain[0] / (own.boundary_layer * own.damping[0])
        return VelocityGain((1.0 + gain) * own.rate, own.rate)

    def command(
        self, arm: Arm, parameters: SlidingModeParameters, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see JointLaw."""
        dq_r, ddq_r = desired.reference(parameters.rate, q, dq)
        s = dq_r - dq
        saturated = np.array([clip(arm.backend, share, 1.0) for share in s / parameters.boundary_layer])
        torque = parameters.damping * s + parameters.switching_gain * saturated
        return torque + passive_dynamics(arm, q, dq, dq_r, ddq_r), state


CONFIG = SlidingModeConfig
FOLLOWS_JOINTS = True
TAKES_DRAWN = True
build = joint_law_builder(SlidingMode)
