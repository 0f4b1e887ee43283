"""Tip pose tracking within joint position and speed limits, and a continuous reference for jumps."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.controllers.kinematic.resolved_rate import ResolvedRate
from runner.robots.model import RobotModel
from runner.trajectories.blend import quintic_blend

_DAMPED_BELOW = 0.02  # of the reach: singular value below which the inverse is damped
_FREE = 1e-6  # m and rad; farther from the pose wanted than this the tip is held back


class LimitedMotion:
    """Joint positions that bring the tip to one wanted pose after the other, a period each.

    A joint's speed stays within its limit, and within a share of what is left to its position limit: it nears that
    exponentially and never passes it. Near singular postures the inverse is damped: the tip stays behind.

    Args:
        model: The arm.
        period: Time for each pose, in s.
        approach: How fast a joint may near its position limit, as a share of what is left, in 1/s.

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
        """Whether the tip came to the last pose wanted."""

    def reset(self, q: FloatArray) -> None:
        """Stand at joint positions, shape (nq,), in rad."""
        self._q, self._held, self.free = q.copy(), {}, True

    @property
    def tip(self) -> "pin.SE3":
        """Pose of the tip at the last command, in the base frame."""
        pin.framesForwardKinematics(self._model, self._data, self._q)
        return self._data.oMf[self._frame].copy()

    def lead(self, time: float, wanted: "pin.SE3") -> "tuple[FloatArray, pin.SE3]":
        """Return the joint positions for a wanted pose, shape (nq,), in rad, and the pose that they reach."""
        J = pin.computeFrameJacobian(self._model, self._data, self._q, self._frame, pin.LOCAL_WORLD_ALIGNED)
        tip = self._data.oMf[self._frame]
        way = np.concatenate([wanted.translation - tip.translation, pin.log3(wanted.rotation @ tip.rotation.T)])
        near = self._share * (self._limits - self._q)
        lower, upper = np.minimum(np.maximum(near, -self._speeds), self._speeds)
        dq = self._rate.solve(J, way / self._period, np.zeros(len(self._q)), lower, upper)
        self._q = self._q + self._period * dq
        reached = self.tip
        off = np.concatenate([wanted.translation - reached.translation, pin.log3(wanted.rotation @ reached.rotation.T)])
        # A step along the tangent is off by the square of its length at most, which the next one mends.
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
        """Return what has held the tip back, each with the time when it first did."""
        return [f"{what} has held the tool back, first at t = {time:.4g} s" for what, time in self._held.items()]


class Approach:
    """A position that follows a desired one as it is, and goes to one that jumps by a rest-to-rest quintic.

    Args:
        period: Time between two positions, in s.
        speed: Largest speed at which a jump is made good, in m/s; a desired motion faster than it is a jump too.
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
        """Move on by one period towards a desired position, shape (3,), in m, and return the reference."""
        if self._way is None and np.linalg.norm(desired - self.position) <= self._speed * self._period:
            self.position = desired.copy()
            return self.position
        if self._way is None or np.linalg.norm(desired - self._way[1]) > self._speed * self._period:
            self._way, self._time = (self.position, desired.copy()), 0.0
        start, goal = self._way
        self._time += self._period
        duration = 1.875 * float(np.linalg.norm(goal - start)) / self._speed  # the quintic's peak is 1.875 of its mean
        share, _, _ = quintic_blend(np.array([self._time / duration]))
        self.position = start + share * (goal - start)
        if self._time >= duration:
            self._way = None
        return self.position
