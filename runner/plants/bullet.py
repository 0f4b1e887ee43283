"""PyBullet plant: Featherstone's articulated-body algorithm with semi-implicit Euler integration."""

from dataclasses import replace
from typing import Literal

from runner.base import engines
from runner.base.errors import ConfigError
from runner.plants.bullet_engine import Bullet
from runner.plants.decoupled import Motion, TorquePlantConfig, assemble_flexible, assemble_plant, find_motion
from runner.plants.decoupled import default_step as default_step
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.flexible_config import modes as modes
from runner.plants.plant import Plant
from runner.plants.stepped_bullet import SteppedBullet, find_motion_of, find_step
from runner.robots.model import RobotModel
from runner.robots.robot import Robot

IMPLICIT_CONTACT = True  # a wall's spring and damper act in each step, from the velocity at its end
STOPS = True


class BulletConfig(TorquePlantConfig):
    """Config of the PyBullet plant.

    Attributes:
        kind: Name in the registry.
        step: Integration step, in s; None selects a tenth of the fastest controller period, a quarter with several
            stages.
        flexible_joints: Springs between motors and links; None for rigid joints.
    """

    kind: Literal["bullet"]
    flexible_joints: FlexibleJointsConfig | None = None


CONFIG = BulletConfig


def build(config: BulletConfig, robot: Robot, step: float, steps_per_tick: int) -> Plant:
    """Build the plant of a config."""
    if config.flexible_joints is not None:
        parts = config, config.flexible_joints, robot, step, steps_per_tick
        return assemble_flexible(*parts, lambda links: make_arm(robot.urdf, links, step, 1))
    tick = step * steps_per_tick
    return assemble_plant(config, robot, tick, lambda urdf, model: make_arm(urdf, model, step, steps_per_tick))


def motion(config: BulletConfig, robot: Robot, step: float, steps_per_tick: int) -> Motion | None:
    """Return the motion of one arm by Bullet's step; None with springs, friction, several arms, or without the step."""
    if config.flexible_joints is not None:
        return None
    found = find_motion(robot, config)
    own = found.arms[0]
    bullet = None
    if len(found.arms) == 1 and not own.friction.acts.any():
        bullet = find_motion_of(own.urdf, own.model, step, steps_per_tick)
    return None if bullet is None else replace(found, bullet=bullet)


def make_arm(urdf: str, model: RobotModel, step: float, steps_per_tick: int) -> Plant:
    """Return an arm that moves as in PyBullet, by the compiled step if it is equal; arguments are those of Bullet.

    Raises:
        ConfigError: if PyBullet cannot load the URDF, or is needed and missing.
    """

    def make() -> Bullet:
        if not engines.has_pybullet():
            raise ConfigError(engines.bullet_missing())
        return Bullet(urdf, model, step, steps_per_tick)

    code = find_step(urdf, model, step, steps_per_tick)
    return make() if code is None else SteppedBullet(code, model, steps_per_tick, make)
