"""Quintic straight-line motion from rest to rest."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.geometry import Point
from runner.trajectories.motion import quintic_motion
from runner.trajectories.trajectory import Trajectory


class QuinticConfig(StrictModel):
    """Config of a quintic.

    Attributes:
        kind: Name of the kind in the registry.
        start: Tip position at t = 0, in m; None is the tip at the home configuration.
        goal: Tip position at t_f, in m.
        duration: t_f, in s.
    """

    kind: Literal["quintic"]
    start: Metres[Point | None]
    goal: Metres[Point]
    duration: Seconds[PositiveFloat]


CONFIG = QuinticConfig


def build(config: QuinticConfig, start: FloatArray) -> Trajectory:
    """Build the quintic that a config describes; `start` is the tip at t = 0."""
    return quintic_motion(start, np.array(config.goal), config.duration)
