"""Adaptive passivity-based joint control, with adaptation to body inertias and friction."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import DesiredJoints, JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.torque_law import Arm, PinocchioArm
from runner.robots.drawn import each_run
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar

_SPEED, _ACCELERATION = 1.0, 2.0  # rad/s and rad/s^2, or m/s and m/s^2: of the motions that scale the gains
_NOTHING = 1e-200  # kg m^2/s^4, avoids 0 / 0 if s is zero
_SMOOTH = 0.01  # rad/s or m/s, below which the modelled dry friction fades


class AdaptiveConfig(JointLawConfig):
    """Config of adaptive joint control.

    Attributes:
        kind: Registry name of the controller.
        natural_frequency: lambda, K_D / diag M, and omega_n of the tip motion, in rad/s.
        damping_ratio: xi of the tip motion; the joints have two equal poles.
        adaptation_gain: Speed of the adaptation. With scale parameter, the square of the bound on its fastest mode,
            relative to omega_n^2; with scale uniform, the gain of every parameter.
        scale: Gains of the parameters: one scaled to each parameter, or the same for all.
        friction: True if the law also adapts to viscous and dry friction of each joint.
    """

    kind: Literal["adaptive"]
    adaptation_gain: PositiveFloat
    scale: Literal["parameter", "uniform"]
    friction: bool


class AdaptiveParameters(NamedTuple):
    """The parameters of adaptive control."""

    rate: Scalar  # lambda, in 1/s
    damping: Array  # diagonal of K_D, shape (nq,), in kg m^2/s
    armature: Array  # diagonal of A, shape (nq,), in kg m^2
    adaptation_gain: Array  # diagonal of Gamma, shape (P,)
    initial_parameters: FloatArray  # theta^ at the first tick, shape (P,)
    swings: Scalar  # a omega_n^2 / 4, above which a direction of s oscillates, in 1/s^2
    limits: Array  # torque limits, shape (nq,), in N m; infinite if there is none


class Adaptive(JointLaw[AdaptiveParameters, AdaptiveConfig]):
    r"""Adaptive control (Slotine and Li, International Journal of Robotics Research 6(3), 1987).

    .. math::

        \tau = Y(q, \dot q, \dot q_r, \ddot q_r) \hat\theta + A \ddot q_r + K_D s, \qquad
        \dot{\hat\theta} = \Gamma Y^T s, \qquad \dot q_r = \dot q_d + \lambda (q_d - q), \qquad s = \dot q_r - \dot q

    with lambda = omega_n and K_D = omega_n D, D = diag M(home). Y is Arm.regressor, theta^ starts at the nominal
    parameters, and A is the known armature. V = (s^T M s + (theta - theta^)^T Gamma^-1 (theta - theta^)) / 2 changes at
    the rate -s^T K_D s for any theta, so s decays. theta^ converges to theta only as far as the motion excites it.

    With friction, Y has two more columns for each joint: viscous friction, dq_r, and dry friction,
    dq_d / sqrt(dq_d^2 + (0.01 rad/s)^2). The latter has the sign of the desired motion, so it does not chatter with
    noise or at standstill. Both parameters start at 0. For a joint motion without feedforward dq_d is 0, and dry
    friction does not adapt.

    Linearised at a configuration, s obeys M d2s/dt2 + K_D ds/dt + Y Gamma Y^T s = 0. Its frequencies are those of
    D^-1/2 Y Gamma Y^T D^-1/2, whose largest eigenvalue is at most the sum of Gamma_p |D^-1/2 Y_p|^2. So scaled gains,
    Gamma_p = a omega_n^2 / (N max |D^-1/2 Y_p|^2) for N excited parameters, keep them below sqrt(a) omega_n for any
    units and sizes of the parameters. The maximum is over motions at home, with gravity, of each joint and of all
    together at 1 rad/s and 2 rad/s^2. Parameters that none of these excites do not adapt.

    Scaled gains are reduced in a tick in which s would oscillate, s^T Y Gamma Y^T s > a omega_n^2 s^T D s / 4, as in
    much faster motions. The s of a joint is ignored while its torque is beyond its limit. V can increase in both cases.
    """

    def choose_parameters(self, model: RobotModel, config: AdaptiveConfig, inertia: FloatArray) -> AdaptiveParameters:
        """Return the parameters of the law above; see JointLaw."""
        self._friction = config.friction
        theta = np.concatenate([model.inertial_parameters, np.zeros(2 * model.nq if config.friction else 0)])
        gains = np.full(len(theta), config.adaptation_gain)
        self._bounded = config.scale == "parameter"
        if self._bounded:
            arm, home = PinocchioArm(model, config.gravity_compensation), self._motion.parameters.posture.rest
            scales = each_run(lambda D: self._scales(arm, home, D), inertia)
            gains = gains * (config.natural_frequency**2 * scales)
        self._state_size = len(gains)
        return AdaptiveParameters(
            rate=config.natural_frequency,
            damping=config.natural_frequency * inertia,
            armature=model.armature,
            adaptation_gain=gains,
            initial_parameters=theta,
            limits=model.effort_limits,
            swings=0.25 * config.adaptation_gain * config.natural_frequency**2,
        )

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(self.parameters.own.rate, self.parameters.own.rate)

    def own_start(self) -> FloatArray:
        """Return the nominal parameters, shape (P,)."""
        return self.parameters.own.initial_parameters

    def command(
        self, arm: Arm, parameters: AdaptiveParameters, q: Array, dq: Array, desired: DesiredJoints, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above, and the parameter estimates at the next tick; see JointLaw."""
        dq_r, ddq_r = desired.reference(parameters.rate, q, dq)
        s = dq_r - dq
        Y = arm.regressor(q, dq, dq_r, ddq_r)
        if self._friction:
            Y = np.concatenate([Y, _friction(arm, dq_r, desired.dq)], axis=1)
        torque = Y.dot(state) + parameters.armature * ddq_r + parameters.damping * s
        teaches = np.array([_taught(arm, *of) for of in zip(torque, parameters.limits, s, strict=True)])
        gradient = Y.T.dot(teaches)
        change = desired.period * parameters.adaptation_gain * gradient
        if self._bounded:
            braked = parameters.swings / parameters.rate * (parameters.damping * teaches).dot(teaches) + _NOTHING
            needed = (parameters.adaptation_gain * gradient).dot(gradient)
            change = change * (braked / arm.backend.maximum(braked, needed))
        return torque, state + change

    def _scales(self, arm: PinocchioArm, home: FloatArray, D: FloatArray) -> FloatArray:
        """Return 1 / (N max |D^-1/2 Y_p|^2) of each parameter, shape (..., P); 0 for one that is not excited."""
        largest = np.zeros(1)
        for way in (*np.eye(len(home)), np.ones(len(home))):
            speed = _SPEED * way
            Y = arm.regressor(home, speed, speed, _ACCELERATION * way)
            if self._friction:
                Y = np.concatenate([Y, _friction(arm, speed, speed)], axis=1)
            largest = np.maximum(largest, (Y**2 / D[..., None]).sum(axis=-2))
        excited = largest > np.finfo(float).eps * largest.max(axis=-1, keepdims=True)
        count = excited.sum(axis=-1, keepdims=True)
        scales: FloatArray = np.divide(1.0, count * largest, out=np.zeros_like(largest), where=excited)
        return scales


def _taught(arm: Arm, torque: Scalar, limit: Scalar, s: Scalar) -> Scalar:
    """Return the s of a joint, or 0 if its torque is beyond its limit."""
    within = arm.backend.less(arm.backend.absolute(torque), limit)
    return arm.backend.choose(within, lambda: np.array([s]), lambda: np.zeros(1))[0]


def _friction(arm: Arm, dq_r: Array, dq_d: Array) -> Array:
    """Return the columns of viscous and of dry friction, shape (nq, 2 nq)."""
    dry = np.array([speed / arm.backend.sqrt(speed * speed + _SMOOTH**2) for speed in dq_d])
    return np.concatenate([np.diag(dq_r), np.diag(dry)], axis=1)


CONFIG = AdaptiveConfig
FOLLOWS_JOINTS = True
TAKES_DRAWN = True
build = joint_law_builder(Adaptive)
