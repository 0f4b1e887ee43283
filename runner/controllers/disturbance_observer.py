"""Momentum-based disturbance observer for any torque controller."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, NamedTuple, cast

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Controller, Loop
from runner.controllers.torque_filter import TorqueFilter, with_filter
from runner.controllers.torque_law import Arm, clip
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import RadiansPerSecond
from runner.schema.values import by_name
from runner.symbolic.maths import Array, Scalar


class DisturbanceObserverConfig(StrictModel):
    """Config of the disturbance observer.

    Attributes:
        bandwidth: Observer bandwidth L of all control loops, in rad/s, or a mapping with one for each loop (for each
            stage if each has a loop); None for no observer.
        torque: Torque in the observer: commanded, within the limits, or measured by joint torque sensors, which is
            smaller by the friction.
    """

    bandwidth: RadiansPerSecond[PositiveFloat | dict[str, PositiveFloat] | None]
    torque: Literal["commanded", "measured"]

    def by_loop(self, loops: Sequence[Loop]) -> list[float] | None:
        """Return the bandwidth of each loop, in rad/s; None without an observer.

        Raises:
            ConfigError: if a mapping names other loops.
        """
        if self.bandwidth is None:
            return None
        if isinstance(self.bandwidth, dict):
            names = [loop.name for loop in loops]
            return by_name("disturbance_observer.bandwidth", self.bandwidth, names, "loop")
        return [self.bandwidth] * len(loops)


class ObserverParameters(NamedTuple):
    """The parameters of an observer."""

    gain: Scalar  # filter gain per tick, 1 - exp(-L h)
    period: Scalar  # time h between two ticks, in s
    limits: Array  # torque limits of the commanded joints, shape (n,), in N m; infinite if there is none
    gravity: Array  # nominal gravity in the base frame, shape (3,), in m/s^2


class MomentumObserver(TorqueFilter):
    r"""Observer of the disturbance torques d on the joints of a control law.

    After De Luca, Albu-Schaeffer, Haddadin and Hirzinger (IEEE/RSJ International Conference on Intelligent Robots and
    Systems, 2006). The generalised momenta p = M dq and the estimate r obey

    .. math:: \dot p = \tau + C^T \dot q - G + d, \qquad \dot r = L (\dot p - \tau - C^T \dot q + G - r) = L (d - r)

    without a measured acceleration. With tau constant between ticks,

    .. math::

        \bar d_k = \frac{p_k - p_{k-1}}{h} - \tau_{k-1} - \frac{b_{k-1} + b_k}{2}, \quad b = C^T \dot q - G, \qquad
        r_k = r_{k-1} + (1 - e^{-L h}) (\bar d_k - r_{k-1})

    is that filter, exact except for the mean of b. tau is the acting torque: within the limits and delayed as the
    commands are. So r does not wind up at a torque limit.

    Args:
        robot: The nominal robot.
        joints: Joints that the law commands.
        bandwidth: L, in rad/s.
        period: Time between two ticks of the law, in s.
        limits: Torque limits of these joints, shape (n,), in N m; infinite if there is none.
        late: Delay of commands, in ticks of the law.
        reads_joint_torques: True if tau is measured by the joint torque sensors.
    """

    def __init__(
        self,
        robot: Robot,
        joints: slice,
        bandwidth: float,
        period: float,
        limits: FloatArray,
        late: int,
        reads_joint_torques: bool = False,
    ) -> None:
        self.reads_joint_torques = reads_joint_torques
        self.models = (robot.model,)
        self._first, self._end, self._late = joints.start, joints.stop, late
        gain = -math.expm1(-bandwidth * period)
        self.parameters = ObserverParameters(gain, period, limits, robot.model.gravity)

    @property
    def state_size(self) -> int:
        """Size of the state."""
        return (3 + self._late) * len(self.parameters.limits)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the state before the first tick: the arm at rest at q, without a disturbance."""
        b = 0.0 - self.models[0].copy().gravity_torque(q)[self._first : self._end]
        return np.concatenate([np.zeros(len(b)), 0.5 * self.parameters.period * b, *[-b] * (1 + self._late)])

    def measured(self, state: FloatArray, reading: FloatArray) -> FloatArray:
        """Return the state with the torques measured since the last tick, of every joint, shape (nq,)."""
        n = len(self.parameters.limits)
        return np.concatenate([state[: 2 * n], reading[self._first : self._end], state[3 * n :]])

    def filter(
        self, arm: Arm, parameters: ObserverParameters, time: Scalar, q: Array, dq: Array, torque: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law less the estimated disturbance, and the state; see TorqueFilter."""
        n, h, less = len(parameters.limits), parameters.period, arm.backend.less
        r, before, acted, to_come = state[:n], state[n : 2 * n], state[2 * n : 3 * n], state[3 * n :]
        p, b = (values[self._first : self._end] for values in arm.momentum(q, dq, parameters.gravity))
        d, before = momentum_balance(p, b, h, before, acted)
        r = r + parameters.gain * (d - r)
        asked = torque - r
        held = np.array([clip(arm.backend, *pair) for pair in zip(asked, parameters.limits, strict=True)])
        if self._late:  # the first torque acts from the start
            first = np.concatenate([held] * self._late)
            to_come = arm.backend.choose(less(time, 0.5 * h), lambda: first, lambda: to_come)
        return asked, np.concatenate([r, before, to_come, held])


def momentum_balance(p: Array, b: Array, h: Scalar, before: Array, acted: Array) -> tuple[Array, Array]:
    """Return the mean disturbance over the last period h, and p + h b / 2, for the next tick; see MomentumObserver.

    Args:
        p: Generalised momenta, shape (n,).
        b: Their rate without torques, shape (n,); see Arm.momentum.
        h: Period, in s.
        before: p + h b / 2 at the last tick.
        acted: Mean torques since the last tick, shape (n,), in N m.
    """
    return (p - 0.5 * h * b - before) / h - acted, p + 0.5 * h * b


def add_observers(
    config: DisturbanceObserverConfig,
    robot: Robot,
    loops: tuple[Loop, ...],
    limits: FloatArray,
    tick: float,
    late: Sequence[int],
) -> tuple[Loop, ...]:
    """Return the control loops with the disturbance observers of a config, if any.

    Args:
        config: The config.
        robot: The nominal robot.
        loops: Loops that command torques.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite if there is none.
        tick: Time between two ticks of the fastest loop, in s.
        late: Delay of commands of each loop, in these ticks.
    """
    bandwidths = config.by_loop(loops)
    if bandwidths is None:
        return loops
    measures, observed = config.torque == "measured", []
    for loop, bandwidth, delay in zip(loops, bandwidths, late, strict=True):
        own = 0 if measures else delay // round(loop.period / tick)
        observer = MomentumObserver(robot, loop.joints, bandwidth, loop.period, limits[loop.joints], own, measures)
        law = with_filter(cast(Controller, loop.controller), observer, robot.model)
        observed.append(replace(loop, controller=law))
    return tuple(observed)
