"""Watching plants of the user's."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.errors import SimulationError
from runner.guard.faults import ask
from runner.guard.read_only import read_only

FloatArray = NDArray[np.float64]


class WatchedPlant:
    """A plant of the user's that ends the run as a failure where it raises; what it has beside that is its own.

    Args:
        plant: The plant.

    Attributes:
        plant: What is watched.
    """

    def __init__(self, plant: Any, *_: Any) -> None:
        self.plant = plant

    def __getattr__(self, name: str) -> Any:
        return getattr(self.plant, name)

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state; see Plant."""
        ask(self.plant.reset, 0.0, read_only(q), read_only(dq))
        for name in ("q", "dq"):
            found = ask(lambda name=name: np.shape(getattr(self.plant, name)), 0.0)
            if found != q.shape:
                kind = type(self.plant).__name__
                raise SimulationError(f"{kind}.{name} has the shape {found}; it must be {q.shape}", 0.0)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector; see Plant."""
        ask(self.plant.set_gravity, float("nan"), read_only(gravity))

    def advance(self, command: FloatArray) -> None:
        """Advance the plant by a tick; see Plant."""
        ask(self.plant.advance, float("nan"), read_only(command))
