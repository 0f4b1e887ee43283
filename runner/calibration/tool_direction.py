"""Tool direction from two tools of different lengths (Meca500 report, section 3), and its procedure."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, PositiveFloat, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.calibration.procedure import Bench, Outcome, TouchingConfig, touching_postures
from runner.calibration.tool_centre_point import ToolCentrePoint, identify_tool_centre_point
from runner.schema.units import Metres

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


class TwoToolsConfig(TouchingConfig):
    """Config of the procedure; each tool takes all poses.

    Attributes:
        kind: Its name in the registry.
        direction: The true direction in the flange's frame, of any length but zero.
        shorter: Distance of the short tool's tip behind the long one's along it, in m.
    """

    kind: Literal["tool_direction"]
    direction: Annotated[list[float], Field(min_length=3, max_length=3)]
    shorter: Metres[PositiveFloat]

    @field_validator("direction")
    @classmethod
    def _point_somewhere(cls, direction: list[float]) -> list[float]:
        if not any(direction):
            raise ValueError("must not be zero")
        return direction


class TwoTools:
    """The procedure; its errors are the found direction's tilts about the aligned frame's y and x axes.

    Args:
        config: The tools and the poses.
        bench: The arm; its tool is the long one.
    """

    estimates: ClassVar[Mapping[str, str]] = {"alpha": "rad", "beta": "rad"}
    errors: ClassVar[Mapping[str, str]] = {"tilt_x": "rad", "tilt_y": "rad"}
    measures: ClassVar[Mapping[str, str]] = {"angle": "rad", "condition_number": "1", "length": "m"}

    def __init__(self, config: TwoToolsConfig, bench: Bench) -> None:
        self._direction = np.array(config.direction) / np.linalg.norm(config.direction)
        self.truth = np.array(alignment_angles(self._direction))
        tips = bench.tip, bench.tip - config.shorter * self._direction
        self.postures = np.concatenate([touching_postures(bench, tip, config) for tip in tips])
        self._bench, self._repeatability = bench, config.repeatability

    def repeat(self, generator: np.random.Generator) -> Outcome:
        """Calibrate once; see Procedure."""
        long, short = (
            identify_tool_centre_point(*self._bench.read_poses(postures, self._repeatability, generator))
            for postures in np.split(self.postures, 2)
        )
        found = identify_tool_direction(long, short)
        tilt = -found.tilt(self._direction)
        measures = {
            "angle": float(
                np.arctan2(
                    np.linalg.norm(np.cross(found.direction, self._direction)), found.direction @ self._direction
                )
            ),
            "condition_number": max(long.condition_number, short.condition_number),
            "length": float(np.linalg.norm(long.position - short.position)),
        }
        return Outcome(np.array([found.alpha, found.beta]), tilt, found.covariance, measures)


CONFIG = TwoToolsConfig
build = TwoTools
