"""Tool direction procedure with a long and a short tool (Meca500 report, section 3)."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, PositiveFloat, field_validator

from runner.calibration.procedures.bench import Bench
from runner.calibration.procedures.procedure import Outcome
from runner.calibration.procedures.touching import TouchingConfig, touching_postures
from runner.calibration.tool_centre_point import identify_tool_centre_point
from runner.calibration.tool_direction import alignment_angles, identify_tool_direction
from runner.schema.units import Metres


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
