"""External wrench on a tool: sensor reading without bias, weight, inertia (Meca500 report, section 4)."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.calibration.gravity import GravityCalibration
from runner.calibration.tool import Motion, Tool


class WrenchCompensation:
    r"""The external wrench in the sensor's frame, by an identified tool and sensor.

    .. math:: F_e = F - F_0 - F_t, \qquad M_e = M - M_0 - M_t

    (F_t, M_t) is the wrench that the tool puts on the sensor: at rest its weight, G_x = -G (cos theta rho_x + sin theta
    rho_y), G_y = G (sin theta rho_x - cos theta rho_y), G_z = -G rho_z, and r times it.

    Args:
        calibration: Identified tool and sensor.
        inertia: The tool's inertia about its centre of mass in the sensor's frame, shape (3, 3), in kg m^2; weighing
            does not show it, and nothing but angular acceleration and gyroscopic moments needs it.
        gravity: Magnitude of gravity along -z of the base, in m/s^2.
    """

    def __init__(self, calibration: GravityCalibration, inertia: FloatArray, gravity: float) -> None:
        self._bias = np.concatenate([calibration.force_bias, calibration.moment_bias])
        self._tool = Tool(calibration.mass, calibration.centre_of_mass, inertia)
        self._gravity = np.array([0.0, 0.0, -gravity])
        c, s = np.cos(calibration.theta), np.sin(calibration.theta)
        self._mounting = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def external(self, reading: FloatArray, orientation: FloatArray, motion: Motion) -> FloatArray:
        """Return the wrench that the world puts on the tool, about the sensor's origin along its axes, shape (6,).

        Args:
            reading: The sensor's, in N and N m, shape (6,).
            orientation: 0R6, flange in the base frame, shape (3, 3).
            motion: The sensor's motion; REST leaves the tool's inertia in the result.
        """
        gravity = (orientation @ self._mounting).T @ self._gravity
        wrench: FloatArray = reading - self._bias - self._tool.load(gravity, motion)
        return wrench
