"""Gravity calibration (Meca500 report, section 4): tool as a rigid body, identification, and compensated readings."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.calibration.orientations import check_orientations, force_matrix, moment_matrix
from runner.sensing.wrench import cross_matrix


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


PARAMETERS = ("mass", "theta", "r_x", "r_y", "r_z", "F_x0", "F_y0", "F_z0", "M_x0", "M_y0", "M_z0")
"""Order of the covariance's rows; in kg, rad, m, N and N m."""


@dataclass(frozen=True)
class GravityCalibration:
    """An identified tool and sensor.

    Attributes:
        mass: Of the tool, in kg.
        theta: Turn of the sensor about the flange's z axis, in rad.
        centre_of_mass: r, of the tool in the sensor's frame, shape (3,), in m.
        force_bias: F0, shape (3,), in N.
        moment_bias: M0, shape (3,), in N m.
        covariance: Covariance of the errors of PARAMETERS, shape (11, 11).
        condition_numbers: Of the force and the moment step's orientations.
    """

    mass: float
    theta: float
    centre_of_mass: FloatArray
    force_bias: FloatArray
    moment_bias: FloatArray
    covariance: FloatArray
    condition_numbers: tuple[float, float]

    @property
    def values(self) -> FloatArray:
        """The estimates in the order of PARAMETERS, shape (11,)."""
        return np.concatenate(
            [[self.mass, self.theta], self.centre_of_mass, self.force_bias, self.moment_bias], dtype=np.float64
        )


def identify_gravity(
    readings: FloatArray,
    orientations: FloatArray,
    gravity: float,
    reading_variance: FloatArray,
    orientation_covariances: FloatArray,
) -> GravityCalibration:
    r"""Return mass, centre of mass, mounting angle and biases from readings at rest, in two least-squares steps.

    The sensor's frame is the flange's turned by theta about z, R_s = 0R6 Rz(theta); it reads
    F = F0 + g_s and M = M0 + r x g_s with the tool's weight g_s = R_s' (0, 0, -G). The moment step gives r and k,
    the force step G cos theta, G sin theta, G and F0, and the moment biases follow:

    .. math::

        M = -[F]_\times r + k, \qquad F = F_0 - (\rho_x G_c + \rho_y G_s, \rho_y G_c - \rho_x G_s, \rho_z G), \qquad
        \theta = \operatorname{atan2}(G_s, G_c), \qquad M_0 = k + r \times F_0

    rho is the third row of 0R6. The report names its elements r_02, r_12, r_22, which taken as row and column are the
    third column; swaps G_y and G_z in its first equations; writes F_x0 for M_x0 there; and takes theta by arc cosine
    or sine, which loses its sign or its half turn.

    The covariance carries the readings' noise and the orientations' errors through both steps, to first order. The
    forces' noise is also in the moment step's matrix (n_M - r x n_F).

    Args:
        readings: Forces in N and moments in N m in the sensor's frame, each at rest, shape (N, 6).
        orientations: 0R6, flange in the base frame, shape (N, 3, 3).
        gravity: Magnitude of gravity along -z of the base, in m/s^2.
        reading_variance: Variance of each axis of a reading, shape (6,).
        orientation_covariances: Covariance of each orientation's error, a rotation vector in the base frame, shape
            (N, 3, 3), in rad^2.

    Raises:
        ConfigError: if the orientations are too few or too much alike, or the readings show no tool's weight.
    """
    conditions = check_orientations(orientations)
    forces, moments = readings[:, :3], readings[:, 3:]
    B = force_matrix(orientations)
    B_inverse = np.linalg.pinv(B)
    G_c, G_s, G, *offsets = B_inverse @ forces.reshape(-1)
    if G <= 0.0 or np.hypot(G_c, G_s) == 0.0:
        raise ConfigError(
            f"calibration.readings: they show a weight of {G:.3g} N, turning with the flange as no tool's would; "
            f"check that a tool is mounted and that readings and orientations belong together"
        )
    A_inverse = np.linalg.pinv(moment_matrix(forces))
    r, k = np.split(A_inverse @ moments.reshape(-1), 2)
    theta, F_0 = float(np.arctan2(G_s, G_c)), np.array(offsets)

    steps = np.zeros((12, 12))  # covariance of (r, k, G_c, G_s, G, F0)
    c, s = np.cos(theta), np.sin(theta)
    into_sensor = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    vertical = cross_matrix(np.array([0.0, 0.0, 1.0]))
    for index, (orientation, covariance) in enumerate(zip(orientations, orientation_covariances, strict=True)):
        rows = slice(3 * index, 3 * index + 3)
        turned = G * into_sensor @ orientation.T @ vertical  # how an orientation's error enters the force step
        gain = np.zeros((12, 9))
        gain[:6, :3], gain[:6, 3:6] = -A_inverse[:, rows] @ cross_matrix(r), A_inverse[:, rows]
        gain[6:, :3], gain[6:, 6:] = B_inverse[:, rows], B_inverse[:, rows] @ turned
        noise = np.zeros((9, 9))
        noise[:6, :6], noise[6:, 6:] = np.diag(reading_variance), covariance
        steps += gain @ noise @ gain.T
    outcome = _outcome_jacobian(r, F_0, G_c, G_s, gravity)
    return GravityCalibration(
        mass=float(G / gravity),
        theta=theta,
        centre_of_mass=r,
        force_bias=F_0,
        moment_bias=k + np.cross(r, F_0),
        covariance=outcome @ steps @ outcome.T,
        condition_numbers=conditions,
    )


def _outcome_jacobian(r: FloatArray, F_0: FloatArray, G_c: float, G_s: float, gravity: float) -> FloatArray:
    """Return the derivatives of PARAMETERS by (r, k, G_c, G_s, G, F0), shape (11, 12)."""
    jacobian = np.zeros((11, 12))
    jacobian[0, 8] = 1.0 / gravity
    jacobian[1, 6:8] = np.array([-G_s, G_c]) / (G_c**2 + G_s**2)
    jacobian[2:5, :3] = jacobian[5:8, 9:] = jacobian[8:, 3:6] = np.eye(3)
    jacobian[8:, :3], jacobian[8:, 9:] = -cross_matrix(F_0), cross_matrix(r)
    return jacobian


class WrenchCompensation:
    r"""The external wrench in the sensor's frame, by an identified tool and sensor.

    .. math:: F_e = F - F_0 - F_t, \qquad M_e = M - M_0 - M_t

    (F_t, M_t) is the wrench that the tool puts on the sensor: at rest its weight, G_x = -G (cos theta rho_x + sin theta
    rho_y), G_y = G (sin theta rho_x - cos theta rho_y), G_z = -G rho_z, and r times it.

    Args:
        calibration: Identified tool and sensor.
        inertia: The tool's inertia about its centre of mass in the sensor's frame, shape (3, 3), in kg m^2; weighing
            does not show it, and only angular acceleration and gyroscopic moments need it.
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
