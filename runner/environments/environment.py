"""What every environment offers."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Environment(Protocol):
    """The world around the tip, as the wrench that it puts on it."""

    def reset(self, tip: FloatArray) -> None:
        """Start with the tip at a position in the base frame, shape (3,), in m."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip.

        Args:
            time: Time since the start, in s.
            tip: Tip position in the base frame, shape (3,), in m.
            velocity: Its linear velocity, shape (3,), in m/s.

        Returns:
            Force in N and moment about the tip in N m, along the base's axes, shape (6,).
        """
        ...
