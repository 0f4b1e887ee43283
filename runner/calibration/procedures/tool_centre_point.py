"""Tool centre point procedure: one point touched in several poses (Meca500 report, section 2)."""

from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from runner.calibration.procedures.bench import Bench
from runner.calibration.procedures.procedure import Outcome
from runner.calibration.procedures.touching import TouchingConfig, touching_postures
from runner.calibration.tool_centre_point import identify_tool_centre_point


class TouchedPointConfig(TouchingConfig):
    """Config of the procedure.

    Attributes:
        kind: Its name in the registry.
    """

    kind: Literal["tool_centre_point"]


class TouchedPoint:
    """The procedure; its measures are the condition of the poses, and their distance from one point.

    Args:
        config: The poses.
        bench: The arm.
    """

    estimates: ClassVar[Mapping[str, str]] = {"x": "m", "y": "m", "z": "m"}
    errors: ClassVar[Mapping[str, str]] = estimates
    measures: ClassVar[Mapping[str, str]] = {"condition_number": "1", "smallest_singular_value": "1", "residual": "m"}

    def __init__(self, config: TouchedPointConfig, bench: Bench) -> None:
        self.truth = bench.tip
        self.postures = touching_postures(bench, bench.tip, config)
        self._bench, self._repeatability = bench, config.repeatability

    def repeat(self, generator: np.random.Generator) -> Outcome:
        """Calibrate once; see Procedure."""
        found = identify_tool_centre_point(*self._bench.read_poses(self.postures, self._repeatability, generator))
        measures = {name: float(getattr(found, name)) for name in self.measures}
        return Outcome(found.position, found.position - self.truth, found.covariance, measures)


CONFIG = TouchedPointConfig
build = TouchedPoint
