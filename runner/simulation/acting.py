"""Active command of each control loop in each tick, with computation delay."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray


class CommandTiming:
    """The commands that act.

    A loop's command is a row of its joints, of the tick in which it was given; until its next one it stands in every
    tick.

    Args:
        joints: The joints of each loop.
        rows: Tick whose command acts in each tick, of each loop, shapes (T,).
    """

    def __init__(self, joints: Sequence[slice], rows: Sequence[NDArray[np.int64]]) -> None:
        self._joints, self._rows = joints, rows
        self._alike = all(np.array_equal(rows[0], own) for own in rows[1:])

    def at(self, commands: FloatArray, k: int) -> FloatArray:
        """Return what acts in tick k, shape (nq,), of commands in each tick, shape (T, nq)."""
        if self._alike:
            acting: FloatArray = commands[self._rows[0][k]]
            return acting
        return np.concatenate([commands[own[k], joints] for joints, own in zip(self._joints, self._rows, strict=True)])

    def throughout(self, commands: FloatArray) -> FloatArray:
        """Return what acts in every tick, shape (T, nq)."""
        parts = [commands[own, joints] for joints, own in zip(self._joints, self._rows, strict=True)]
        return np.concatenate(parts, axis=1)


def constant_delay(joints: int, delay: int, ticks: int) -> CommandTiming:
    """Return that all commands act so many ticks late, in some ticks."""
    return CommandTiming([slice(0, joints)], [np.maximum(np.arange(ticks) - delay, 0)])
