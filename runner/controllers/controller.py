"""What every controller offers."""

from dataclasses import dataclass
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
            dq: Measured joint velocities, shape (nq,), in rad/s; of every joint, those of other stages included.
            reference: Desired tip position, velocity and acceleration in the base frame, shape (3, 3): a row each,
                in m, m/s, m/s^2.

        Returns:
            Torques of the joints it commands before any limit, in N m; valid until the next call.

        Raises:
            numpy.linalg.LinAlgError: where the law has no solution, such as at a singular posture.
        """
        ...


@dataclass(frozen=True)
class Loop:
    """One control loop of a robot.

    Attributes:
        name: Name of the stage that it commands, or of what it does.
        joints: The joints that it commands, within the robot's.
        period: Time between two of its ticks, in s.
        controller: The control law; it is given the measurement of every joint.
    """

    name: str
    joints: slice
    period: float
    controller: Controller
