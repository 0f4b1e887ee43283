"""Notch filter of controller torques, against excitation of a resonance, and its config."""

import math
from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Controller, Loop
from runner.controllers.torque_filter import TorqueFilter, with_filter
from runner.controllers.torque_law import Arm
from runner.robots.robot import Robot, by_joint
from runner.schema.model import StrictModel
from runner.schema.units import Hertz
from runner.schema.values import NotchPerStage
from runner.symbolic.maths import Array, Scalar


class NotchConfig(StrictModel):
    """Config of a second-order notch in the torques; see runner.controllers.notch.

    Attributes:
        frequency: Blocked frequency, in Hz. One for all joints or a list with one for each joint, by stage if the robot
            has several; None for joints without a notch.
        width: Width between the frequencies of gain 0.71 (-3 dB), in Hz.
    """

    frequency: Hertz[NotchPerStage]
    width: Hertz[PositiveFloat]

    def by_joint(self, arm: Robot) -> FloatArray:
        """Return the frequency of each joint, shape (nq,), in Hz; infinite without a notch.

        Raises:
            ConfigError: if the values do not fit the robot's stages and joints, or no joint has a notch.
        """
        frequency = by_joint("notch.frequency", self.frequency, arm.stage_joints)
        if not np.isfinite(frequency).any():
            raise ConfigError(
                "notch.frequency: null for every joint; take notch=none for torques as the laws ask for them"
            )
        return frequency


class NotchParameters(NamedTuple):
    """The parameters of a notch."""

    period: Scalar  # time between two ticks, in s
    b: Array  # coefficients of the unfiltered torques now, one and two ticks ago, shape (3, n)
    a: Array  # coefficients of the filtered torques one and two ticks ago, shape (2, n)


class Notch(TorqueFilter):
    r"""A second-order notch filter for each torque, by the bilinear transform, exact at the notch frequency.

    .. math:: H(s) = \frac{s^2 + \omega^2}{s^2 + \Delta s + \omega^2}, \qquad
        y_k = b_0 u_k + b_1 u_{k-1} + b_2 u_{k-2} - a_1 y_{k-1} - a_2 y_{k-2}

    The state starts as if the first torques had always acted, so that gravity compensation passes at once.

    Args:
        frequency: omega / (2 pi) of each torque, shape (n,), in Hz, below half the sampling rate; infinite for none.
        width: Delta / (2 pi), in Hz.
        period: Time between two ticks of the law, in s.
    """

    def __init__(self, frequency: FloatArray, width: float, period: float) -> None:
        each = np.array([_coefficients(float(f), width, period) for f in frequency]).T
        self.parameters = NotchParameters(period, each[:3], each[3:])

    @property
    def state_size(self) -> int:
        """Size of the state."""
        return 2 * len(self.parameters.b[0])

    def filter(
        self, arm: Arm, parameters: NotchParameters, time: Scalar, q: Array, dq: Array, torque: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the filtered torques and the state; see TorqueFilter."""
        (b0, b1, b2), (a1, a2), n, backend = parameters.b, parameters.a, len(torque), arm.backend
        late = (b2 - a2) * torque
        rest = np.concatenate([(b1 - a1) * torque + late, late])
        state = backend.choose(backend.less(time, 0.5 * parameters.period), lambda: rest, lambda: state)
        passed = b0 * torque + state[:n]
        return passed, np.concatenate([b1 * torque - a1 * passed + state[n:], b2 * torque - a2 * passed])


def _coefficients(frequency: float, width: float, period: float) -> tuple[float, float, float, float, float]:
    """Return b0, b1, b2, a1 and a2 of the notch at a frequency, in Hz; those of the identity if it is infinite.

    Orfanidis, Introduction to Signal Processing, 1996, equations 11.3.6, 11.3.7 and 11.3.21 with a gain of -3 dB at the
    edges of the width; rounded as by `scipy.signal.iirnotch`.
    """
    if math.isinf(frequency):
        return 1.0, 0.0, 0.0, 0.0, 0.0
    turn = 2.0 * frequency / (1.0 / period)  # angle per tick / pi
    gain = 1.0 / (1.0 + math.tan(turn / (frequency / width) * math.pi / 2.0))
    cosine = math.cos(turn * math.pi)
    return gain, gain * (-2.0 * cosine), gain, -2.0 * gain * cosine, 2.0 * gain - 1.0


def add_notch(robot: Robot, loops: tuple[Loop, ...], frequency: FloatArray, width: float) -> tuple[Loop, ...]:
    """Return the control loops with notch-filtered torques.

    Args:
        robot: The nominal robot.
        loops: Loops that command torques.
        frequency: Frequency of each joint of the robot, shape (nq,), in Hz; infinite for none.
        width: Width of the notch, in Hz.
    """
    notches = [Notch(frequency[loop.joints], width, loop.period) for loop in loops]
    return tuple(
        replace(loop, controller=with_filter(cast(Controller, loop.controller), notch, robot.model))
        for loop, notch in zip(loops, notches, strict=True)
    )
