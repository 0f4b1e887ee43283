"""What every plant offers."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Plant(Protocol):
    """A simulated arm under torques that are held between control ticks. It never sees the controller.

    Attributes:
        q: True joint positions, shape (nq,), in rad; renewed in place by reset and advance.
        dq: True joint velocities, shape (nq,), in rad/s; likewise.
    """

    q: FloatArray
    dq: FloatArray

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state."""

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector in the arm's base frame, shape (3,), in m/s^2."""

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques, shape (nq,), in N m, for one control tick of simulated time."""

    def close(self) -> None:
        """Release what the plant holds."""


class PositionPlant(Plant, Protocol):
    """A simulated arm whose joints follow commanded positions; `advance` takes these, shape (nq,), in rad.

    Attributes:
        tau: Torques of the tick that `advance` just made, shape (nq,), in N m; renewed in place.
        load: Joint torques that the world adds in the next tick, shape (nq,), in N m; written in place.
    """

    tau: FloatArray
    load: FloatArray


def innermost(plant: Any) -> Any:
    """Return the plant that moves the arm, below servos and friction."""
    while hasattr(plant, "plant"):
        plant = plant.plant
    return plant
