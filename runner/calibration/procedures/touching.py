"""Arm configurations with the tool tip on one point."""

from typing import Annotated

import numpy as np
from pydantic import Field, NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.base.sanitize import quoted
from runner.calibration.procedures.bench import Bench
from runner.robots.inverse_kinematics import solve_tip_pose
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, Metres, Radians


class TouchingConfig(StrictModel):
    """Config of the poses.

    Attributes:
        poses: Their number.
        spread: Angle by which the flange is tilted in each, in rad.
        posture: Joint positions about which it is tilted, in rad (m for prismatic joints). The tip keeps its
            position there. None is home.
        repeatability: To which the arm repeats its flange's position at home, in m.
    """

    poses: Annotated[int, Field(ge=1, le=1000)]
    spread: Radians[Annotated[float, Field(gt=0.0, lt=np.pi)]]
    posture: JointPosition[list[float] | None]
    repeatability: Metres[NonNegativeFloat]


def touching_postures(bench: Bench, tip: FloatArray, config: TouchingConfig) -> FloatArray:
    """Return postures within the joint limits, the flange tilted about axes all around its z axis.

    Args:
        bench: The arm.
        tip: The tool centre point in the flange's frame, shape (3,), in m, which touches the same point in each.
        config: The poses wanted.

    Returns:
        Shape (poses, nq), in rad.

    Raises:
        ConfigError: if a posture has the wrong length, or the arm cannot take a pose.
    """
    middle = bench.home if config.posture is None else np.array(config.posture)
    if middle.shape != bench.home.shape:
        raise ConfigError(
            f"calibration.posture: must have {bench.home.size} values, or be null; found {quoted(config.posture)}"
        )
    central = bench.flange.tip_pose(middle)
    point = central[:3, :3] @ tip + central[:3, 3]
    postures = []
    for number in range(config.poses):
        around = 2.0 * np.pi * number / config.poses
        pose = np.eye(4)
        pose[:3, :3] = central[:3, :3] @ pin.exp3(config.spread * np.array([np.cos(around), np.sin(around), 0.0]))
        pose[:3, 3] = point - pose[:3, :3] @ tip
        try:
            postures.append(solve_tip_pose(bench.flange, pose, middle))
        except ConfigError:
            raise ConfigError(
                f"calibration.spread: {config.spread:g} rad is more than the arm can do with the tip at "
                f"{np.round(point, 4).tolist()} m: pose {number + 1} of {config.poses} is out of its reach or its "
                "joint limits; take a smaller spread, or another posture"
            ) from None
    return np.array(postures)
