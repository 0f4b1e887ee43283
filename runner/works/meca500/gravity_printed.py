"""The gravity compensation as the report prints it (section 4), where it is misprinted, to show what that gives."""

from dataclasses import dataclass

import numpy as np

from runner.calibration.orientations import force_matrix
from runner.reporting.document import FloatArray


@dataclass(frozen=True)
class ForceStep:
    """What a force step gives.

    Attributes:
        G_c: G cos(theta), in N.
        G_s: G sin(theta), in N.
        G: Weight as the third unknown, in N.
        residual: Root mean square of what is left of the forces, in N.
    """

    G_c: float
    G_s: float
    G: float
    residual: float


def force_step(forces: FloatArray, orientations: FloatArray) -> ForceStep:
    """Solve the force step with the third rows of the orientations.

    The report does not define r. With r the inverse rotation its r_02, r_12, r_22 are these rows; with r = 0R6 they are
    the third columns: that is this function with each orientation transposed.

    Args:
        forces: Read in the sensor's frame, shape (N, 3), in N.
        orientations: 0R6, shape (N, 3, 3).
    """
    B = force_matrix(orientations)
    solution = np.linalg.lstsq(B, forces.reshape(-1), rcond=None)[0]
    left = forces.reshape(-1) - B @ solution
    G_c, G_s, G = solution[:3].tolist()
    return ForceStep(G_c, G_s, G, float(np.sqrt(np.mean(left**2))))


def swapped_moment_step(forces: FloatArray, moments: FloatArray) -> FloatArray:
    """Return the centre of mass with G_y and G_z swapped, as in the section's first equations, shape (3,), in m.

    Args:
        forces: Read in the sensor's frame, shape (N, 3), in N.
        moments: Read there, shape (N, 3), in N m.
    """
    swapped = forces[:, [0, 2, 1]]
    A = np.vstack([np.hstack([_minus_cross(force), np.eye(3)]) for force in swapped])
    centre: FloatArray = np.linalg.lstsq(A, moments.reshape(-1), rcond=None)[0][:3]
    return centre


def theta_by_arc_cosine(G_c: float, G: float) -> float:
    """Return theta as printed first, in rad."""
    return float(np.arccos(np.clip(G_c / G, -1.0, 1.0)))


def theta_by_arc_sine(G_s: float, G: float) -> float:
    """Return theta as printed second, in rad."""
    return float(np.arcsin(np.clip(G_s / G, -1.0, 1.0)))


def _minus_cross(vector: FloatArray) -> FloatArray:
    x, y, z = vector
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
