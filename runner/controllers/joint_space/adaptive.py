"""Adaptive passivity-based joint control, with adaptation to body inertias and friction."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.joint_space.joint_law import JointLaw, JointLawConfig, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.joint_space.joint_motion import DesiredJoints, JointMotionNumbers
from runner.controllers.torque_law import Arm, PinocchioArm
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar

_SPEED, _ACCELERATION = 1.0, 2.0  # rad/s and rad/s^2, or m/s and m/s^2: of the motions that scale the gains
_NOTHING = 1e-200  # kg m^2/s^4, by which gains stay as they are where s is zero
_SMOOTH = 0.01  # rad/s or m/s, below which the believed dry friction fades


class AdaptiveConfig(JointLawConfig):
    """Config of adaptive control of the joints.

    Attributes:
        kind: Its name in the registry.
        natural_frequency: lambda, and K_D / diag M, and omega_n of the motion that leads the tip, in rad/s.
        damping_ratio: xi of the motion that leads the tip; the joints have two equal poles.
        adaptation_gain: How fast the law adapts. With scale parameter, the square of what its fastest mode may reach,
            as a share of omega_n^2; with scale uniform, the gain of every parameter.
        scale: Whether each parameter has a gain that suits it, or all have one.
        friction: Whether it adapts to viscous and dry friction of each joint, too.
    """

    kind: Literal["adaptive"]
    adaptation_gain: PositiveFloat
    scale: Literal["parameter", "uniform"]
    friction: bool


class AdaptiveNumbers(NamedTuple):
    """The numbers of adaptive control.

    Attributes:
        motion: Of the joint motion that is followed.
        rate: lambda, in 1/s.
        damping: Diagonal of K_D, shape (nq,), in kg m^2/s.
        armature: Diagonal of A, shape (nq,), in kg m^2.
        adaptation_gain: Diagonal of Gamma, shape (P,).
        initial_parameters: theta^ at the first tick, shape (P,).
        swings: a omega_n^2 / 4, above which a direction of s swings, in 1/s^2.
        limits: Torque limits, shape (nq,), in N m; infinite where there is none.
    """

    motion: JointMotionNumbers
    rate: Scalar
    damping: Array
    armature: Array
    adaptation_gain: Array
    initial_parameters: FloatArray
    swings: Scalar
    limits: Array


class Adaptive(JointLaw[AdaptiveNumbers, AdaptiveConfig]):
    r"""Adaptive control (Slotine and Li, International Journal of Robotics Research 6(3), 1987).

    .. math::

        \tau = Y(q, \dot q, \dot q_r, \ddot q_r) \hat\theta + A \ddot q_r + K_D s, \qquad
        \dot{\hat\theta} = \Gamma Y^T s, \qquad \dot q_r = \dot q_d + \lambda (q_d - q), \qquad s = \dot q_r - \dot q

    with lambda = omega_n and K_D = omega_n D, D = diag M(home). Y is Arm.regressor, and theta starts at what is
    believed; A is the armature, which is known. V = (s^T M s + (theta - theta^)^T Gamma^-1 (theta - theta^)) / 2 falls
    as -s^T K_D s, whatever theta is, so that s fades; theta^ goes to theta only as far as the motion excites it.

    With friction, Y has a column for each joint's viscous friction, dq_r, and one for its dry friction,
    dq_d / sqrt(dq_d^2 + (0.01 rad/s)^2): the sign of the motion that is wanted, which no noise and no standstill makes
    chatter. Both start at 0, and without feedforward the latter stays so.

    Linear at a posture, s obeys M d2s/dt2 + K_D ds/dt + Y Gamma Y^T s = 0. Its frequencies are those of
    D^-1/2 Y Gamma Y^T D^-1/2, whose largest eigenvalue is at most the sum of Gamma_p |D^-1/2 Y_p|^2. So a scale by
    parameter, Gamma_p = a omega_n^2 / (P max |D^-1/2 Y_p|^2), keeps them below sqrt(a) omega_n whatever the units and
    sizes of the P parameters; the largest is that of gravity at home with each joint alone, and all together, moving at
    1 rad/s and 2 rad/s^2 there. What none of these excites does not adapt. In a tick in which s itself would swing,
    s^T Y Gamma Y^T s > a omega_n^2 s^T D s / 4, as in motions much faster than these, all gains are as much smaller; in
    one in which a torque is beyond its limit, the s of its joint teaches nothing. V may rise in both.
    """

    def choose_numbers(
        self, model: RobotModel, config: AdaptiveConfig, rest: FloatArray, motion: JointMotionNumbers
    ) -> AdaptiveNumbers:
        """Return the numbers of the law above; see JointLaw."""
        self._friction = config.friction
        theta = np.concatenate([model.inertial_parameters, np.zeros(2 * model.nq if config.friction else 0)])
        D = model.mass_matrix(rest).diagonal()
        gains = np.full(len(theta), config.adaptation_gain)
        self._bounded = config.scale == "parameter"
        if self._bounded:
            gains *= config.natural_frequency**2 * self._scales(model, config.gravity_compensation, rest, D)
        self._remembers = len(gains)
        return AdaptiveNumbers(
            motion=motion,
            rate=config.natural_frequency,
            damping=config.natural_frequency * D,
            armature=model.armature,
            adaptation_gain=gains,
            initial_parameters=theta,
            limits=model.effort_limits,
            swings=0.25 * config.adaptation_gain * config.natural_frequency**2,
        )

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(self.numbers.rate, self.numbers.rate)

    def with_limits(self, limits: FloatArray) -> "Adaptive":
        """Return the law that is told its torque limits; see ControlLaw."""
        return self.with_numbers(limits=limits)

    def own_start(self) -> FloatArray:
        """Return the parameters that are believed at first, shape (P,)."""
        return self.numbers.initial_parameters

    def command(
        self, arm: Arm, numbers: AdaptiveNumbers, q: Array, dq: Array, desired: DesiredJoints, memory: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above, and the parameters believed at the next tick; see JointLaw."""
        dq_r = desired.dq + numbers.rate * (desired.q - q)
        ddq_r = desired.ddq + numbers.rate * (desired.dq - dq)
        s = dq_r - dq
        Y = arm.regressor(q, dq, dq_r, ddq_r)
        if self._friction:
            Y = np.concatenate([Y, _friction(arm, dq_r, desired.dq)], axis=1)
        torque = Y.dot(memory) + numbers.armature * ddq_r + numbers.damping * s
        teaches = np.array([_taught(arm, *of) for of in zip(torque, numbers.limits, s, strict=True)])
        gradient = Y.T.dot(teaches)
        change = numbers.motion.period * numbers.adaptation_gain * gradient
        if self._bounded:
            braked = numbers.swings / numbers.rate * (numbers.damping * teaches).dot(teaches) + _NOTHING
            needed = (numbers.adaptation_gain * gradient).dot(gradient)
            change = change * (braked / arm.backend.maximum(braked, needed))
        return torque, memory + change

    def _scales(self, model: RobotModel, gravity_compensation: bool, home: FloatArray, D: FloatArray) -> FloatArray:
        """Return 1 / (P max |D^-1/2 Y_p|^2) of each parameter, shape (P,); 0 of one that nothing excites."""
        arm, largest = PinocchioArm(model, gravity_compensation), np.zeros(1)
        for way in (*np.eye(model.nq), np.ones(model.nq)):
            speed = _SPEED * way
            Y = arm.regressor(home, speed, speed, _ACCELERATION * way)
            if self._friction:
                Y = np.concatenate([Y, _friction(arm, speed, speed)], axis=1)
            largest = np.maximum(largest, (Y**2 / D[:, None]).sum(axis=0))
        excited = largest > np.finfo(float).eps * largest.max()
        scales: FloatArray = np.zeros_like(largest)
        scales[excited] = 1.0 / (excited.sum() * largest[excited])
        return scales


def _taught(arm: Arm, torque: Scalar, limit: Scalar, s: Scalar) -> Scalar:
    """Return what a joint's s teaches: nothing in a tick in which its torque is beyond its limit."""
    within = arm.backend.less(arm.backend.absolute(torque), limit)
    return arm.backend.choose(within, lambda: np.array([s]), lambda: np.zeros(1))[0]


def _friction(arm: Arm, dq_r: Array, dq_d: Array) -> Array:
    """Return the columns of viscous and of dry friction, shape (nq, 2 nq)."""
    dry = np.array([speed / arm.backend.sqrt(speed * speed + _SMOOTH**2) for speed in dq_d])
    return np.concatenate([np.diag(dq_r), np.diag(dry)], axis=1)


CONFIG = AdaptiveConfig
FOLLOWS_JOINTS = True
build = joint_law_builder(Adaptive)
