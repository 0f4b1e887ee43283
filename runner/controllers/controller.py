"""What every controller offers."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Controller(Protocol):
    """A control law, pure in (time, measurement, reference) apart from what `reset` clears."""

    def reset(self) -> None:
        """Forget everything of an earlier run."""

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the joint torques.

        Args:
            time: Time since the start, in s.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            reference: Desired tip position, velocity and acceleration in the base frame, shape (3, 3): a row each,
                in m, m/s, m/s^2.

        Returns:
            Torques before any limit, shape (nq,), in N m; valid until the next call.

        Raises:
            numpy.linalg.LinAlgError: where the law has no solution, such as at a singular posture.
        """
        ...
