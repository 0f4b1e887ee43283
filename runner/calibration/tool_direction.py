"""Tool direction from two tools of different lengths (Meca500 report, section 3)."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.calibration.tool_centre_point import ToolCentrePoint

_MIN_RATIO = 5.0  # of the tips' distance to its standard deviation


@dataclass(frozen=True)
class ToolDirection:
    """An identified direction.

    Attributes:
        direction: Unit vector from the short tool's tip to the long one's in the flange's frame, shape (3,).
        alpha: First angle of the alignment Rx(alpha) Ry(beta), in rad.
        beta: Second angle, in rad.
        covariance: Covariance of the direction's error along the aligned frame's x and y axes, shape (2, 2), in rad^2.
    """

    direction: FloatArray
    alpha: float
    beta: float
    covariance: FloatArray

    @property
    def rotation(self) -> FloatArray:
        """The aligned frame in the flange's, shape (3, 3): its z axis is the direction."""
        return alignment(self.alpha, self.beta)

    def tilt(self, direction: FloatArray) -> FloatArray:
        """Return another unit vector's components along the aligned frame's x and y axes, shape (2,)."""
        tilt: FloatArray = (self.rotation.T @ direction)[:2]
        return tilt


def alignment(alpha: float, beta: float) -> FloatArray:
    """Return Rx(alpha) Ry(beta), shape (3, 3) (report eq. 7)."""
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    return np.array([[cb, 0.0, sb], [sa * sb, ca, -sa * cb], [-ca * sb, sa, ca * cb]])


def alignment_angles(direction: FloatArray) -> tuple[float, float]:
    """Return alpha and beta in rad with Rx(alpha) Ry(beta) e_z = t, the unit direction t, shape (3,).

    alpha turns z onto the direction's projection on the yz plane, beta about the new y axis onto the direction. Along
    x, where any alpha does, it is zero.
    """
    t_x, t_y, t_z = direction
    return float(np.arctan2(-t_y, t_z)), float(np.arctan2(t_x, np.hypot(t_y, t_z)))


def identify_tool_direction(long: ToolCentrePoint, short: ToolCentrePoint) -> ToolDirection:
    """Return the direction t from a short tool's tip to a long one's (report eq. 6).

    Args:
        long: Tool centre point of the long tool.
        short: Tool centre point of the short tool, calibrated apart.

    Raises:
        ConfigError: if the two tips are too close to each other.
    """
    offset, covariance = long.position - short.position, long.covariance + short.covariance
    length, deviation = float(np.linalg.norm(offset)), float(np.sqrt(np.trace(covariance)))
    if length <= _MIN_RATIO * deviation:
        raise ConfigError(
            f"calibration.shorter: the tips are {length:.3g} m apart, known to {deviation:.3g} m; a direction "
            f"needs {_MIN_RATIO:g} times that. Take tools whose lengths differ more"
        )
    direction = offset / length
    alpha, beta = alignment_angles(direction)
    across = alignment(alpha, beta)[:, :2]
    return ToolDirection(direction, alpha, beta, across.T @ covariance @ across / length**2)
