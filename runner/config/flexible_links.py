"""Flexible links: checks and the rigid nominal model."""

import numpy as np

from runner.base.errors import ConfigError
from runner.config.flexible_joints import find_flexibility
from runner.config.run import RunConfig
from runner.plants.rk4_flexible_links import Rk4FlexibleLinksConfig
from runner.robots.armature import with_armature
from runner.robots.chain import stiffen_robot
from runner.robots.robot import Robot

_FASTEST = 0.5  # step times the largest rate; see runner/config/flexible_joints.py


def is_flexible(config: RunConfig) -> bool:
    """Tell whether joints or links are flexible; laws that believe in their motors are not compiled."""
    return isinstance(config.plant, Rk4FlexibleLinksConfig) or find_flexibility(config) is not None


def with_nominal_links(config: RunConfig, nominal: Robot) -> Robot:
    """Return a rigid nominal robot with the masses of flexible links and motors."""
    if not isinstance(config.plant, Rk4FlexibleLinksConfig):
        return nominal
    return with_armature(stiffen_robot(nominal, config.plant.beams(config.arm)), config.plant.motors(config.arm))


def check_flexible_links(config: RunConfig) -> None:
    """Check that links that bend meet a step that follows their fastest mode, and nothing that takes them for rigid.

    Raises:
        ConfigError: where they do not.
    """
    if not isinstance(config.plant, Rk4FlexibleLinksConfig):
        return
    config.plant.motors(config.arm)
    problems = []
    if config.has_contact:
        problems.append("a force on the tip would act on rigid links; take environment=free and a law that feels none")
    if config.loaded:
        problems.append("the payload cannot change on the way; take robot.payload.schedule=[]")
    if config.joint_torques is not None:
        problems.append("torque sensors are read in rigid arms; take joint_torque_sensor.noise=null")
    problems = [f"plant.links: {problem}" for problem in problems]
    try:
        rate, tick, step = config.plant.largest_rate(config.arm), config.timing.tick, config.timing.step
    except np.linalg.LinAlgError:
        rate, tick, step = np.inf, config.timing.tick, config.timing.step
    if not rate < 1e9:
        problems.append("plant.motor_inertia: a link without mass turns with its motor alone; give each joint one")
    elif rate * step > _FASTEST:
        problems.append(
            f"plant.step: {step:g} s is too long for the fastest mode of the links, {rate / (2 * np.pi):.3g} Hz at "
            f"home; allowed: up to {_FASTEST / rate:.3g} s, such as {tick / np.ceil(rate * tick / _FASTEST):g}"
        )
    if problems:
        raise ConfigError(problems)
