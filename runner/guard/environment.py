"""Watching environments of the user's."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.guard.faults import ask, checked
from runner.guard.read_only import read_only

FloatArray = NDArray[np.float64]


class WatchedEnvironment:
    """An environment of the user's that ends the run as a failure where it raises, or gives no finite wrench.

    Args:
        environment: What is watched.
    """

    def __init__(self, environment: Any, *_: Any) -> None:
        self._environment = environment

    def reset(self, tip: FloatArray) -> None:
        """Reset it; see Environment."""
        ask(self._environment.reset, 0.0, read_only(tip))

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return its wrench; see Environment."""
        law = self._environment.wrench
        return checked(ask(law, time, time, read_only(tip), read_only(velocity)), (6,), law, time)
