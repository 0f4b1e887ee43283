"""What every plant offers."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from runner.robots import RobotModel

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Arm:
    """What a plant simulates.

    Attributes:
        urdf: The URDF's text.
        model: Its rigid-body model, with gravity.
    """

    urdf: str
    model: RobotModel


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

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques, shape (nq,), in N m, for one control tick of simulated time."""

    def close(self) -> None:
        """Release what the plant holds."""
