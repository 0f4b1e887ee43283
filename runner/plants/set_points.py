"""Servo set-points for every tick from less frequent joint position commands."""

import numpy as np

from runner.base.arrays import FloatArray


class SetPoints:
    """What a position servo follows: commanded joint positions, no faster than the joints may move.

    Args:
        ticks_per_command: Ticks from one command to the next.
        tick: Time between two set-points, in s.
        speed_limits: Largest joint speeds, shape (nq,), in rad/s; infinite where there is none.
        interpolate: Whether a set-point moves evenly from one command to the next, a command's period late, or jumps
            as far as the speed limits allow.
        delay: Ticks that a command is late.
    """

    def __init__(
        self, ticks_per_command: int, tick: float, speed_limits: FloatArray, interpolate: bool, delay: int = 0
    ) -> None:
        self._ramp = ticks_per_command if interpolate else 1
        self._ticks_per_command = ticks_per_command
        self._tick = tick
        self._farthest = speed_limits * tick
        self._interpolate = interpolate
        self.position = np.zeros(len(speed_limits))
        """Set-point at the end of the tick, shape (nq,), in rad; renewed in place."""
        self.velocity = np.zeros(len(speed_limits))
        """Its velocity within the tick, shape (nq,), in rad/s; zero where it jumps."""
        self._first = -delay % ticks_per_command
        self._count = self._first

    def reset(self, q: FloatArray) -> None:
        """Stand still at joint positions."""
        self.position[:], self.velocity[:], self._count = q, 0.0, self._first

    def advance(self, command: FloatArray) -> None:
        """Move on by one tick towards the command, joint positions of shape (nq,), in rad."""
        left = self._ramp - self._count % self._ramp  # ticks until the command is to be reached
        step = (command - self.position) / left
        np.clip(step, -self._farthest, self._farthest, out=step)
        self.position += step
        if self._interpolate:
            self.velocity[:] = step / self._tick
        self._count = (self._count + 1) % self._ticks_per_command
