"""Iterative learning control of periodic motions, around computed torque."""

from copy import copy
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Controller, VelocityGain
from runner.controllers.joint_space.computed_torque import ComputedTorque, ComputedTorqueConfig
from runner.controllers.joint_space.joint_law import JointLawConfig, JointMotion, joint_law_builder
from runner.controllers.joint_space.joint_law import start_posture as start_posture
from runner.controllers.torque_law import PinocchioArm
from runner.robots.model import RobotModel
from runner.schema.units import Seconds

_NOTHING = np.zeros(0)
_MOST_TICKS = 1_000_000  # per cycle, because the law stores the torques of each


class IterativeLearningConfig(JointLawConfig):
    """Config of iterative learning around computed torque.

    Attributes:
        kind: Registry name of the controller.
        repeats_every: Cycle time of the desired motion, in s; a multiple of the period.
        learning_gain: gamma, the fraction of the feedback torque that is added to the next cycle; below 2.
        cutoff: Cutoff frequency of the low-pass Q, in units of omega_n; None learns at every frequency.
    """

    kind: Literal["iterative_learning"]
    repeats_every: Seconds[PositiveFloat | None]
    learning_gain: Annotated[float, Field(gt=0.0, lt=2.0)]
    cutoff: PositiveFloat | None


class IterativeLearning(Controller):
    r"""Learning of the feedback torque (Arimoto, Kawamura and Miyazaki, Journal of Robotic Systems 1(2), 1984).

    .. math::

        \tau = M \ddot q_d + V + G + f_j + u_j, \qquad f_j = M (2 \xi \omega_n \dot e + \omega_n^2 e), \qquad
        u_{j+1}(t) = Q [u_j(t) + \gamma (f_j(t) + \tau_\mathrm{applied} - \tau)]

    in cycle j, with e = q_d - q and u_0 = u_1 = 0. Nothing is learned in the first cycle, because the arm still
    recovers from its start. Under a constant M, each cycle multiplies the feedback torque by

    .. math:: 1 - \gamma T(j w), \qquad
        T(s) = (2 \xi \omega_n s + \omega_n^2) / (s^2 + 2 \xi \omega_n s + \omega_n^2)

    at each frequency w (Bristow, Tharayil and Alleyne, IEEE Control Systems Magazine 26(3), 2006). Its modulus is below
    1 everywhere for gamma < 2 - 1 / (2 xi^2). Sampling adds phase lag to T near the Nyquist frequency, so Q stops the
    learning there: Q(j w) = 1 / (1 + (w / w_c)^4), zero-phase, over the cycle as a periodic signal. Q is the squared
    modulus of a second-order Butterworth filter, and w_c is `cutoff` omega_n.

    Torque beyond a limit is subtracted from the learned torque. At a limit, u converges to the torque that the limit
    leaves after the feedforward, by a factor 1 - gamma in each cycle without Q.

    Args:
        model: The arm.
        config: Config of the law.
        rest: Configuration of the posture task, shape (nq,), in rad.
        joints: True if the desired motion is a joint motion; see JointMotion.

    Attributes:
        learned: u of this cycle, shape (N, nq), in N m, with a row for each tick.

    Raises:
        ConfigError: if the cycle time is missing, not a multiple of the period, or has too many ticks, or if the arm
            has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: IterativeLearningConfig, rest: FloatArray, joints: bool) -> None:
        self._ticks = _count_ticks(config)
        common = {name: getattr(config, name) for name in JointLawConfig.model_fields}
        feedback = ComputedTorqueConfig(kind="computed_torque", integral_gain=0.0, **common)
        self._motion = JointMotion(model, feedback, rest, joints)
        self._law = ComputedTorque(model, feedback, rest, joints)
        self._arm = PinocchioArm(model, config.gravity_compensation)
        self._period, self._gain = config.period, config.learning_gain
        rate = 2.0 * np.pi * np.fft.rfftfreq(self._ticks, config.period)
        cutoff = np.inf if config.cutoff is None else config.cutoff * config.natural_frequency
        self._Q: FloatArray = np.asarray(1.0 / (1.0 + ((rate[:, None] / cutoff) ** 2) ** 2), dtype=np.float64)
        self._shape = (self._ticks, model.nq)
        self._limits = model.effort_limits
        self.reset()

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return self._law.velocity_gain

    def with_limits(self, limits: FloatArray) -> "IterativeLearning":
        """Return the law with its torque limits set; see ControlLaw."""
        other = copy(self)
        other._limits = limits
        other.reset()
        return other

    def reset(self) -> None:
        """Clear the learned torques and the joint motion."""
        self.learned: FloatArray = np.zeros(self._shape)
        self._feedback: FloatArray = np.zeros(self._shape)
        self._state: FloatArray | None = None
        self._tick = 0

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the law above; see Controller.torque."""
        k = round(time / self._period)
        if k >= 2 * self._ticks and k % self._ticks == 0:  # the first cycle includes the start from rest
            self._learn()
        self._tick = k % self._ticks
        state = self._motion.start(q) if self._state is None else self._state
        parameters = self._law.parameters
        desired, self._state = self._motion.follow(self._arm, parameters.motion, reference, state)
        without = self._arm.inverse_dynamics(q, dq, desired.ddq).copy()
        torque, _ = self._law.command(self._arm, parameters.own, q, dq, desired, _NOTHING)
        self._feedback[self._tick] = torque - without
        asked: FloatArray = torque + self.learned[self._tick]
        self._feedback[self._tick] += np.clip(asked, -self._limits, self._limits) - asked
        return asked

    def _learn(self) -> None:
        learned = self.learned + self._gain * self._feedback
        self.learned = np.fft.irfft(self._Q * np.fft.rfft(learned, axis=0), self._ticks, axis=0)


def _count_ticks(config: IterativeLearningConfig) -> int:
    every, period = config.repeats_every, config.period
    if every is None:
        raise ConfigError(
            "controller.repeats_every: null; allowed: the time in s after which the desired motion is the same again"
        )
    if every / period > _MOST_TICKS:
        raise ConfigError(
            f"controller.repeats_every: {every:g} s are {every / period:.3g} of controller.period, {period:g} s; "
            f"allowed: up to {_MOST_TICKS}"
        )
    ticks = round(every / period)
    if ticks < 1 or abs(ticks * period - every) > 1e-9 * every:
        raise ConfigError(
            f"controller.repeats_every: {every:g} s is not a multiple of controller.period, {period:g} s; such as "
            f"{max(ticks, 1) * period:g}"
        )
    return ticks


CONFIG = IterativeLearningConfig
FOLLOWS_JOINTS = True
TAKES_DRAWN = True
build = joint_law_builder(IterativeLearning)
