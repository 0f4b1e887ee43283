"""Periodic straight line from A to B and back, by a cosine of time."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.geometry import Point
from runner.trajectories.motion import PathMotion, Segment
from runner.trajectories.trajectory import Trajectory


class LineConfig(StrictModel):
    """Config of a line.

    Attributes:
        kind: Name of the kind in the registry.
        start: A, the tip position at t = 0, in m; None is the tip at the home configuration.
        goal: B, the tip position half a period later, in m.
        duration: Period T, from A to B and back, in s.
    """

    kind: Literal["line"]
    start: Metres[Point | None]
    goal: Metres[Point]
    duration: Seconds[PositiveFloat]


CONFIG = LineConfig


def build(config: LineConfig, start: FloatArray) -> Trajectory:
    r"""Build the line that a config describes; `start` is the tip at t = 0.

    The xArm7 report ("Trajectory planning") slows the tip down towards both ends, P_A and P_B, by "a sinusoidal
    function" of its coordinate P_ey and prints no formula. It is interpreted as a harmonic motion from rest in A, with
    D = B - A:

    .. math:: x(t) = A + \tfrac{1}{2} D (1 - \cos(2 \pi t / T))

    The position is then a cosine of the phase, and the speed is the sine of the same phase. The peak speed is
    pi |D| / T, half way. The peak acceleration is 2 pi^2 |D| / T^2, at both ends. The acceleration has a step at t = 0,
    because the arm is at rest before.

    Raises:
        ConfigError: if the length of the line is zero.
    """
    end = np.array(config.goal)
    if np.array_equal(start, end):
        raise ConfigError(f"trajectory.goal: {config.goal} m is the start, and a line leads elsewhere. Choose another")
    return PathMotion(Segment(start, end), config.duration, "cosine")
