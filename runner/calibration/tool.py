"""Tool as a rigid body on a force/torque sensor."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin


@dataclass(frozen=True)
class Motion:
    """Motion of the sensor's frame against an inertial frame, along the sensor's axes.

    Attributes:
        angular_velocity: Shape (3,), in rad/s.
        angular_acceleration: Shape (3,), in rad/s^2.
        linear_acceleration: Acceleration of its origin, shape (3,), in m/s^2.
    """

    angular_velocity: FloatArray
    angular_acceleration: FloatArray
    linear_acceleration: FloatArray


REST = Motion(np.zeros(3), np.zeros(3), np.zeros(3))


@dataclass(frozen=True)
class Tool:
    """Mass properties of what hangs on the sensor, in the sensor's frame.

    Attributes:
        mass: In kg.
        centre_of_mass: r, shape (3,), in m.
        inertia: I about the centre of mass, shape (3, 3), in kg m^2.
    """

    mass: float
    centre_of_mass: FloatArray
    inertia: FloatArray

    def load(self, gravity: FloatArray, motion: Motion) -> FloatArray:
        r"""Return the wrench that the tool puts on the sensor by its weight and inertia, by its rigid-body balance.

        .. math::

            F = m (g - a_c), \qquad M = r \times F - I \dot\omega - \omega \times I \omega, \qquad
            a_c = a + \dot\omega \times r + \omega \times (\omega \times r)

        Args:
            gravity: g along the sensor's axes, shape (3,), in m/s^2.
            motion: The sensor's motion.

        Returns:
            Force in N and moment about the sensor's origin in N m, along its axes, shape (6,).
        """
        body = pin.Inertia(self.mass, self.centre_of_mass, self.inertia)
        velocity = pin.Motion(np.zeros(3), motion.angular_velocity)
        acceleration = pin.Motion(motion.linear_acceleration - gravity, motion.angular_acceleration)
        held = body * acceleration + body.vxiv(velocity)  # by the sensor on the tool
        return -np.asarray(held.vector)
