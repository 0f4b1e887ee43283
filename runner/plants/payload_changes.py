"""Payload changes of an arm during the motion."""

from collections.abc import Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.plant import Plant, PlantWrapper


class PayloadChanges(PlantWrapper):
    """Plants of one arm, each with another payload.

    At a change, the arm keeps its position and velocity. The new payload starts with the velocity of the tip, so there
    is no impact. A payload picked up at rest by a moving tip would cause one.

    Args:
        plants: Plant of each payload, in order.
        ticks: First tick of each plant except the first, ascending.
    """

    def __init__(self, plants: Sequence[Plant], ticks: Sequence[int]) -> None:
        super().__init__(plants[0])
        self._plants, self._ticks = plants, ticks
        self._tick = 0
        self.q, self.dq = self.q.copy(), self.dq.copy()

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state, with its first payload; see Plant."""
        self._tick, self.plant = 0, self._plants[0]
        self._put(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
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
        """Release the resources of the plants."""
        for plant in self._plants:
            plant.close()

    def _put(self, q: FloatArray, dq: FloatArray) -> None:
        self.plant.reset(q, dq)
        self.q[:], self.dq[:] = q, dq
