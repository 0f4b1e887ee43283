"""Start configuration of the arm."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers import CONTROLLERS, ControllerConfig
from runner.robots.inverse_kinematics import solve_tip_position
from runner.robots.robot import Robot, end_points


def start_posture(
    controller: ControllerConfig, arm: Robot, start: FloatArray, ignore_base_rotation: bool
) -> FloatArray:
    """Return joint positions that bring the tip to a start, as the controller wants it.

    Where it has no wish, the first stage moves and riding ones stay at home.
    """
    try:
        wanted = CONTROLLERS.start_posture(controller, arm, start)
    except np.linalg.LinAlgError as error:
        raise ConfigError([f"trajectory.start: {error}"]) from error
    if wanted is not None:
        return np.array(wanted, dtype=np.float64)
    home = end_points(arm, arm.home[None], ignore_base_rotation)[:, 0]
    if np.array_equal(start, home[-1]):
        return arm.home
    if len(arm.stages) == 1 or not ignore_base_rotation:
        return solve_tip_position(arm.model, start, arm.home)
    first = arm.stages[0]
    return np.concatenate(
        [solve_tip_position(first.model, start - (home[-1] - home[0]), first.home), arm.home[first.joints.stop :]]
    )
