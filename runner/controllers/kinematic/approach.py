"""Continuous reference for a desired tip position with jumps."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.trajectories.blend import quintic_blend


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
