"""Wall of a run: the part that computes its contact with the tip, and its place."""

import math

from runner.assembly.run_config import RunConfig
from runner.base.errors import ConfigError
from runner.controllers import ChecksStability
from runner.controllers.stability import check_wall
from runner.environments import Environment
from runner.environments.wall import Wall
from runner.plants import Plant


def touches_by_tip(config: RunConfig) -> bool:
    """Return True if the tip, a point, touches a wall in the plant's steps: no tool, and a torque plant.

    Raises:
        ConfigError: if the tip does not move as in rigid bodies, or the plant's contacts do not support armature.
    """
    if config.ignore_base_rotation:
        raise ConfigError(
            "environment.kind: a wall is touched where rigid bodies bring the tip, and "
            "plant.wrist_rotation=parallel leaves the rider's base unturned; set plant.wrist_rotation=real, or "
            "environment=free"
        )
    if config.plant.kind == "bullet" and config.arm.model.armature.any():
        raise ConfigError(
            "environment.kind: a wall found together with robot.armature, which PyBullet's contacts do not know; "
            "take plant=mujoco, robot.armature=0, or environment=free"
        )
    return config.robot.tool is None and config.takes_torques


def add_wall(wall: Wall, config: RunConfig, plant: Plant) -> Environment | None:
    """Add a wall to a plant; return the wall if the loop must compute the contact, None if the plant does.

    Raises:
        ConfigError: if the controller would be unstable on it with ideal joints, or the plant does not support
            friction.
    """
    ideal = not config.takes_torques
    if ideal and isinstance(config.controller, ChecksStability) and config.controller.check_stability:
        late = math.ceil(config.timing.late[0] * config.timing.tick / config.controller.period - 1e-9)
        controller, values = config.controller, wall.config
        check_wall(controller.law, controller.period, values.stiffness, values.damping, late)
    wall.reset(config.path.start)
    tool = config.robot.tool
    ball = (0.0 if tool is None else tool.tip_radius) * wall.normal  # the trajectory is that of the ball's centre
    if not plant.add_wall(wall.point - ball, wall.normal.copy(), wall.config.stiffness, wall.config.damping):
        return wall
    if wall.config.friction:
        raise ConfigError(
            f"environment.friction: {wall.config.friction:g} found, and plant={config.plant.kind} makes the "
            "contact of a tool without friction; take 0, robot.tool=null (the tip touches), or plant=rk4"
        )
    return None
