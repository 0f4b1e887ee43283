"""Wall contact: setup in the plant, or in the simulation loop."""

import math

from runner.base.errors import ConfigError
from runner.config.run import RunConfig
from runner.controllers.force.admittance_stability import check_wall
from runner.controllers.kinds import ChecksStability
from runner.environments import Environment
from runner.environments.wall import Wall
from runner.plants import PLANTS, ContactPlant, Plant, unwrapped


def touches_by_tip(config: RunConfig) -> bool:
    """Tell whether the tip of a moving arm, a point, touches a wall within the plant's steps; a tool does else.

    Raises:
        ConfigError: where the plant's tip is none that rigid bodies have, or its contacts know no armature.
    """
    if config.ignore_base_rotation:
        raise ConfigError(
            [
                "environment.kind: a wall is touched where rigid bodies bring the tip, and "
                "plant.wrist_rotation=parallel leaves the rider's base unturned; set plant.wrist_rotation=real, or "
                "environment=free"
            ]
        )
    if config.plant.kind == "bullet" and config.arm.model.armature.any():
        raise ConfigError(
            [
                "environment.kind: a wall found together with robot.armature, which PyBullet's contacts do not know; "
                "take plant=mujoco, robot.armature=0, or environment=free"
            ]
        )
    return config.robot.tool is None and PLANTS.commands(config.plant.kind) == "torque"


def add_wall(wall: Wall, config: RunConfig, plant: Plant) -> Environment | None:
    """Put up a wall in a plant that makes contacts itself, and return what of it is left for the loop to do.

    Raises:
        ConfigError: where the controller would bounce on it with ideal joints, or the plant makes no friction.
    """
    ideal = PLANTS.commands(config.plant.kind) == "position"
    if ideal and isinstance(config.controller, ChecksStability) and config.controller.check_stability:
        late = math.ceil(config.timing.late[0] * config.timing.tick / config.controller.period - 1e-9)
        controller, values = config.controller, wall.config
        check_wall(controller.law, controller.period, values.stiffness, values.damping, late)
    within = unwrapped(plant)
    if not isinstance(within, ContactPlant):
        return wall
    if wall.config.friction:
        raise ConfigError(
            [
                f"environment.friction: {wall.config.friction:g} found, and plant={config.plant.kind} makes the "
                "contact of a tool without friction; take 0, robot.tool=null (the tip touches), or plant=rk4"
            ]
        )
    wall.reset(config.path.start)
    tool = config.robot.tool
    ball = (0.0 if tool is None else tool.tip_radius) * wall.normal  # it is the ball's centre that is led
    within.add_wall(wall.point - ball, wall.normal.copy(), wall.config.stiffness, wall.config.damping)
    return None
