"""Robot arms: URDF and MJCF files, rigid-body models, kinematics and model mismatch."""

from runner.robots.description import find_urdf, read_urdf
from runner.robots.inverse_kinematics import solve_tip_pose, solve_tip_position
from runner.robots.model import RobotModel

__all__ = ["RobotModel", "find_urdf", "read_urdf", "solve_tip_pose", "solve_tip_position"]
