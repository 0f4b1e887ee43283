"""Postures as they stand in the configs of joint trajectories: one value for all joints, or one for each."""

import math
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator

from runner.base.arrays import FloatArray
from runner.robots.robot import Robot
from runner.schema.per_joint import expand


def _posture(value: Any) -> float | list[float]:
    numbers = value if isinstance(value, list) else [value]
    if not all(isinstance(n, int | float) and not isinstance(n, bool) and math.isfinite(n) for n in numbers):
        raise ValueError("must be a number, or a list of numbers with one for each joint")
    return [float(n) for n in numbers] if isinstance(value, list) else float(value)


Posture = Annotated[float | list[float], BeforeValidator(_posture)]


def posture_of(key: str, value: Posture, robot: Robot) -> FloatArray:
    """Return a posture, shape (nq,), in rad.

    Raises:
        ConfigError: if a list has another length than the robot has joints; names the joints.
    """
    return np.array(expand(key, value, robot.model.joint_names))


def start_of(value: Posture | None, robot: Robot) -> FloatArray:
    """Return the posture at t = 0, shape (nq,), in rad; None is home. Raises as posture_of does."""
    return robot.home if value is None else posture_of("trajectory.start_posture", value, robot)
