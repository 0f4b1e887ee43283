"""Payload changes of an arm during the motion."""

from collections.abc import Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.plant import Plant, PlantWrapper


class PayloadChanges(PlantWrapper):
    """Plants of one arm with one payload after another.

    At a change the arm goes on from where it is and as fast as it is: the new payload has the speed that the tip has,
    so that nothing jolts. What is picked up at rest while the tip moves would.

    Args:
        plants: The plant of each payload, in their order.
        ticks: Tick from which each of them but the first moves, ascending.
    """

    def __init__(self, plants: Sequence[Plant], ticks: Sequence[int]) -> None:
        super().__init__(plants[0])
        self._plants, self._ticks = plants, ticks
        self._tick = 0
        self.q, self.dq = self.q.copy(), self.dq.copy()

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state, with its first payload; see Plant."""
        self._tick, self.plant = 0, self._plants[0]
        self._put(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector; see Plant."""
        for plant in self._plants:
            plant.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        now = self._plants[int(np.searchsorted(self._ticks, self._tick, side="right"))]
        if now is not self.plant:
            self.plant = now
            self._put(self.q, self.dq)
        self.plant.advance(tau)
        self.q[:], self.dq[:] = self.plant.q, self.plant.dq
        self._tick += 1

    def close(self) -> None:
        """Release what the plants hold."""
        for plant in self._plants:
            plant.close()

    def _put(self, q: FloatArray, dq: FloatArray) -> None:
        self.plant.reset(q, dq)
        self.q[:], self.dq[:] = q, dq
