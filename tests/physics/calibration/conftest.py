from collections.abc import Callable

import numpy as np
import pytest
from support.arms import model_of
from support.turns import rotation

from runner.calibration.uncertainty import joint_deviation
from runner.robots.inverse_kinematics import solve_tip_pose
from runner.robots.model import RobotModel

REPEATABILITY = 5e-6  # m, the Meca500's
POINT = np.array([0.26, 0.0, 0.13])  # m, in the base frame, which the tip touches
HOME = np.array([0.0, 0.1, 0.1, 0.0, 0.8, 0.0])  # rad, flange forwards and down


@pytest.fixture(scope="session")
def meca500() -> RobotModel:
    return model_of("meca500", "flange")


@pytest.fixture(scope="session")
def deviation(meca500) -> float:
    """Standard deviation of each joint, in rad."""
    return joint_deviation(meca500, np.zeros((1, 6)), REPEATABILITY)


@pytest.fixture(scope="session")
def touching(meca500) -> Callable[..., np.ndarray]:
    """Configurations with a tool's tip at POINT, the flange tilted by an angle about axes all around it."""

    def make(tip, count, tilt) -> np.ndarray:
        postures = []
        for k in range(count):
            pose = np.eye(4)
            around = 2.0 * np.pi * k / count
            axis = tilt * np.array([np.cos(around), np.sin(around), 0.4])
            pose[:3, :3] = rotation(np.array([0.0, 2.1, 0.0])) @ rotation(axis)
            pose[:3, 3] = POINT - pose[:3, :3] @ tip
            postures.append(solve_tip_pose(meca500, pose, HOME))
        return np.array(postures)

    return make
