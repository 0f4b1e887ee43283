"""Tip pose tracking within joint position and speed limits, and a continuous reference for jumps."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.controllers.kinematic.resolved_rate import ResolvedRate
from runner.robots.model import RobotModel
from runner.trajectories.motion import quintic_blend

_DAMPED_BELOW = 0.02  # singular value below which the inverse is damped, as a fraction of the reach
_FREE = 1e-6  # m and rad; distance from the desired pose above which the tip is held back


class LimitedMotion:
    """Joint positions for a sequence of desired tip poses, one in each period.

    The speed of a joint is limited by its speed limit and by a fraction of the distance to its position limit. So a
    joint approaches its position limit exponentially and never exceeds it. Near singular configurations the inverse is
    damped, and the tip lags.

    Args:
        model: The arm.
        period: Time for each pose, in s.
        approach: Maximum speed of a joint towards its position limit, per distance to it, in 1/s.

    Raises:
        ConfigError: if the arm has fewer joints than a pose has dimensions.
    """

    def __init__(self, model: RobotModel, period: float, approach: float) -> None:
        if model.nq < 6:
            raise ConfigError(
                f"controller.kind: admittance leads the tool's pose, 6 dimensions, and the arm has {model.nq} "
                f"joints ({', '.join(model.joint_names)})"
            )
        self._model = model.pin_model
        self._data = self._model.createData()
        self._names = model.joint_names
        self._frame = model.tip_frame
        self._period = period
        self._share = min(approach, 1.0 / period)
        self._limits = model.position_limits
        self._speeds = model.velocity_limits
        self._rate = ResolvedRate(np.ones(model.nq), _DAMPED_BELOW * model.reach)
        self._q = np.zeros(model.nq)
        self._held: dict[str, float] = {}
        self.free = True
        """True if the tip reached the last desired pose."""

    def reset(self, q: FloatArray) -> None:
        """Start at joint positions, shape (nq,), in rad."""
        self._q, self._held, self.free = q.copy(), {}, True

    @property
    def tip(self) -> "pin.SE3":
        """Pose of the tip at the last command, in the base frame."""
        pin.framesForwardKinematics(self._model, self._data, self._q)
        return self._data.oMf[self._frame].copy()

    def follow(self, time: float, wanted: "pin.SE3") -> "tuple[FloatArray, pin.SE3]":
        """Return the joint positions for a desired pose, shape (nq,), in rad, and the pose that they reach."""
        J = pin.computeFrameJacobian(self._model, self._data, self._q, self._frame, pin.LOCAL_WORLD_ALIGNED)
        tip = self._data.oMf[self._frame]
        way = np.concatenate([wanted.translation - tip.translation, pin.log3(wanted.rotation @ tip.rotation.T)])
        near = self._share * (self._limits - self._q)
        lower, upper = np.minimum(np.maximum(near, -self._speeds), self._speeds)
        dq = self._rate.solve(J, way / self._period, np.zeros(len(self._q)), lower, upper)
        self._q = self._q + self._period * dq
        reached = self.tip
        off = np.concatenate([wanted.translation - reached.translation, pin.log3(wanted.rotation @ reached.rotation.T)])
        # A step along the tangent has an error of about its squared length, which the next step corrects.
        self.free = bool(np.abs(off).max() <= _FREE + 2.0 * float(way @ way))
        if not self.free:
            self._note(time, dq, lower, upper)
        return self._q, reached

    def _note(self, time: float, dq: FloatArray, lower: FloatArray, upper: FloatArray) -> None:
        at_bound = (dq <= lower + 1e-9) | (dq >= upper - 1e-9)
        slowed = np.minimum(upper, -lower) < self._speeds - 1e-9
        for name, bound, near in zip(self._names, at_bound, slowed, strict=True):
            if bound:
                self._held.setdefault(f"{name} at its {'position' if near else 'speed'} limit", time)
        if not at_bound.any():
            self._held.setdefault("the posture, singular or nearly so", time)

    def messages(self) -> list[str]:
        """Return the causes that held the tip back, each with its first time."""
        return [f"{what} has held the tool back, first at t = {time:.4g} s" for what, time in self._held.items()]


class Approach:
    """A position that equals the desired one, and follows a jump of it by a rest-to-rest quintic.

    Args:
        period: Time between two positions, in s.
        speed: Maximum speed after a jump, in m/s; a faster desired motion is also a jump.
    """

    def __init__(self, period: float, speed: float) -> None:
        self._period = period
        self._speed = speed
        self.position = np.zeros(3)
        """The reference, shape (3,), in m."""
        self._way: tuple[FloatArray, FloatArray] | None = None
        self._time = 0.0

    def reset(self, position: FloatArray) -> None:
        """Rest at a position, shape (3,), in m."""
        self.position, self._way = position.copy(), None

    def follow(self, desired: FloatArray) -> FloatArray:
        """Advance one period towards a desired position, shape (3,), in m, and return the reference."""
        if self._way is None and np.linalg.norm(desired - self.position) <= self._speed * self._period:
            self.position = desired.copy()
            return self.position
        if self._way is None or np.linalg.norm(desired - self._way[1]) > self._speed * self._period:
            self._way, self._time = (self.position, desired.copy()), 0.0
        start, goal = self._way
        self._time += self._period
        duration = 1.875 * float(np.linalg.norm(goal - start)) / self._speed  # 1.875: peak over mean speed
        share, _, _ = quintic_blend(np.array([self._time / duration]))
        self.position = start + share * (goal - start)
        if self._time >= duration:
            self._way = None
        return self.position
