"""Rotations for the tests of calibration."""

import numpy as np
from scipy.spatial.transform import Rotation


def rotation(vector):
    """The rotation matrix of a rotation vector, shape (3, 3)."""
    return Rotation.from_rotvec(np.asarray(vector)).as_matrix()
