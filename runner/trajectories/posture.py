"""Joint configurations in trajectory configs: one value for all joints, or one for each."""

import math
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator

from runner.base.arrays import FloatArray
from runner.robots.robot import Robot
from runner.schema.per_joint import expand


def _configuration(value: Any) -> float | list[float]:
    numbers = value if isinstance(value, list) else [value]
    if not all(isinstance(n, int | float) and not isinstance(n, bool) and math.isfinite(n) for n in numbers):
        raise ValueError("must be a number, or a list of numbers with one for each joint")
    return [float(n) for n in numbers] if isinstance(value, list) else float(value)


Configuration = Annotated[float | list[float], BeforeValidator(_configuration)]


def configuration_of(key: str, value: Configuration, robot: Robot) -> FloatArray:
    """Return a configuration, shape (nq,), in rad.

    Raises:
        ConfigError: if a list has another length than the robot has joints; names the joints.
    """
    return np.array(expand(key, value, robot.model.joint_names))


def start_of(value: Configuration | None, robot: Robot) -> FloatArray:
    """Return the configuration at t = 0, shape (nq,), in rad; None is home. Raises as configuration_of does."""
    return robot.home if value is None else configuration_of("trajectory.start_configuration", value, robot)
