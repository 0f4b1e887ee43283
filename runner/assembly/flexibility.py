"""Flexible joints and links: checks, and the nominal model."""

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.errors import ConfigError
from runner.controllers.joint_space.motor_pd import MotorPdConfig
from runner.plants import Plant, options_of
from runner.plants.decoupled import TorquePlantConfig, find_motion
from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import FlexibleJoints, MotorSide, links_of
from runner.plants.plant import unwrapped
from runner.plants.rk4_flexible_links import Rk4FlexibleLinksConfig
from runner.robots.robot import Robot, with_armature
from runner.robots.vibration import stiffen_robot

_FASTEST = 0.5  # step h times largest rate: numerical damping ratio, (rate h)^5/144, is 2.2e-4 there


def find_flexibility(config: RunConfig) -> Flexibility | None:
    """Return springs and motors of a run's joints; None for rigid joints.

    Raises:
        ConfigError: see FlexibleJointsConfig.by_joint.
    """
    joints = options_of(config.plant).flexible_joints
    return None if joints is None else joints.by_joint(config.arm)


def with_nominal_flexibility(config: RunConfig, nominal: Robot) -> Robot:
    """Return a rigid nominal robot with the masses of flexible links and the motors of flexible joints or links."""
    if isinstance(config.plant, Rk4FlexibleLinksConfig):
        return with_armature(stiffen_robot(nominal, config.plant.beams(config.arm)), config.plant.motors(config.arm))
    flexibility = find_flexibility(config)
    if flexibility is None:
        return nominal
    own = nominal.model.armature
    return with_armature(nominal, np.where(flexibility.flexible, flexibility.motors, own))


def find_motor_side(config: RunConfig, plant: Plant, nominal: Robot) -> MotorSide | None:
    """Return the motor-side model of drives and encoders; None for rigid joints."""
    springs, joints = unwrapped(plant), options_of(config.plant).flexible_joints
    if not isinstance(springs, FlexibleJoints):
        return None
    known = joints is not None and joints.static_deflection == "known"
    at_motors = joints is not None and joints.encoders == "motor"
    return MotorSide(springs, at_motors, nominal.model if known else None)


def check_flexible_joints(config: RunConfig) -> None:
    """Check that the plant step resolves the fastest mode of flexible joints, and that no part needs rigid joints.

    Raises:
        ConfigError: for a step that is too long, and for each part that needs rigid joints.
    """
    flexibility, by_motors = find_flexibility(config), isinstance(config.controller, MotorPdConfig)
    if by_motors and flexibility is None:
        raise ConfigError(
            "controller.kind: motor_pd turns motors behind springs; take plant=rk4_flexible, or controller=joint_pd"
        )
    if flexibility is None or not isinstance(config.plant, TorquePlantConfig):
        return
    problems = [f"plant.flexible_joints: {problem}" for problem in _refused(config, config.plant, flexibility)]
    links = links_of(config.arm.model, flexibility.flexible)
    rate = flexibility.largest_rate(links.mass_matrix(config.arm.home))
    problems += _long_step(config, "the flexible joints", rate)
    if problems:
        raise ConfigError(problems)


def _long_step(config: RunConfig, parts: str, rate: float) -> list[str]:
    """Return a problem if the plant step does not resolve the fastest mode of flexible parts, with a rate in 1/s."""
    step, tick = config.timing.step, config.timing.tick
    if rate * step > _FASTEST:
        return [
            f"plant.step: {step:g} s is too long for the fastest mode of {parts}, {rate / (2 * np.pi):.3g} Hz at home; "
            f"allowed: up to {_FASTEST / rate:.3g} s, such as {tick / np.ceil(rate * tick / _FASTEST):g}"
        ]
    return []


def _refused(config: RunConfig, plant: TorquePlantConfig, flexibility: Flexibility) -> list[str]:
    """Return a problem for each part of a config that needs rigid joints."""
    problems = []
    if config.commands != "torque":
        problems.append(
            f"{config.controller.kind} commands joint positions, whose servos turn links; take a controller that gives "
            "torques"
        )
    if len(config.arm.stages) > 1 and plant.dynamics == "decoupled":
        problems.append("stages that do not feel each other have rigid joints; take plant.dynamics=coupled")
    (moved,) = find_motion(config.arm, plant.model_copy(update={"dynamics": "coupled", "wrist_rotation": "real"})).arms
    if moved.friction.acts[~flexibility.flexible].any():
        problems.append(
            "plant.friction acts only on the motors of flexible joints; take a list with 0 for the joints that are "
            "rigid"
        )
    if config.wall is not None:
        problems.append("a wall is met by arms with rigid joints; take environment=push or environment=free")
    if config.loaded:
        problems.append("the payload cannot change on the way; take robot.payload.schedule=[]")
    if config.joint_torque_sensor is not None:
        problems.append("torque sensors are read at rigid joints; take joint_torque_sensor.noise=null")
    joints = options_of(config.plant).flexible_joints
    theta = joints is not None and joints.encoders == "motor" and joints.static_deflection == "unknown"
    if isinstance(config.controller, MotorPdConfig) and not theta:
        problems.append(
            "motor_pd reads theta unchanged; take plant.flexible_joints.encoders=motor and .static_deflection=unknown"
        )
    return problems


def is_flexible(config: RunConfig) -> bool:
    """Return True if joints or links are flexible; laws whose model contains the motors are not compiled."""
    return isinstance(config.plant, Rk4FlexibleLinksConfig) or find_flexibility(config) is not None


def check_flexible_links(config: RunConfig) -> None:
    """Check that the plant step resolves the fastest mode of flexible links, and that no part needs rigid links.

    Raises:
        ConfigError: for a step that is too long, and for each part that needs rigid links.
    """
    if not isinstance(config.plant, Rk4FlexibleLinksConfig):
        return
    config.plant.motors(config.arm)
    problems = []
    if config.has_contact:
        problems.append("a force on the tip would act on rigid links; take environment=free and a law that feels none")
    if config.loaded:
        problems.append("the payload cannot change on the way; take robot.payload.schedule=[]")
    if config.joint_torque_sensor is not None:
        problems.append("torque sensors are read in rigid arms; take joint_torque_sensor.noise=null")
    problems = [f"plant.links: {problem}" for problem in problems]
    try:
        rate = config.plant.largest_rate(config.arm)
    except np.linalg.LinAlgError:
        rate = np.inf
    if not rate < 1e9:
        problems.append("plant.motor_inertia: a link without mass turns only with its motor; give each joint one")
    else:
        problems += _long_step(config, "the links", rate)
    if problems:
        raise ConfigError(problems)
