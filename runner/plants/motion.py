"""Moving arms of a robot with joint friction, on a fixed base or on the previous arm."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.per_joint import FrictionConfig, expand

if TYPE_CHECKING:
    from runner.plants.decoupled import TorquePlantConfig


@dataclass(frozen=True)
class ArmMotion:
    """An arm that moves by its own dynamics.

    Attributes:
        urdf: Its URDF's text.
        model: Its model.
        joints: Its joints among those of the robot.
        viscous: Torque per speed in its joints, shape (n,), in N m s/rad.
        coulomb: Torque against any motion, shape (n,), in N m.
    """

    urdf: str
    model: RobotModel
    joints: slice
    viscous: FloatArray
    coulomb: FloatArray


@dataclass(frozen=True)
class Motion:
    """The arms of a robot.

    Attributes:
        robot: The robot.
        arms: One for the whole robot; or one for each of its stages, which ride on each other without feeling it.
        ignore_base_rotation: Whether riders' bases keep their orientation of home.
    """

    robot: Robot
    arms: tuple[ArmMotion, ...]
    ignore_base_rotation: bool


def find_motion(robot: Robot, config: "TorquePlantConfig") -> Motion:
    """Return what moves of a robot; one stage has nothing to couple.

    Args:
        robot: The robot.
        config: Says whether stages act on each other (dynamics), whether a carrier turns its rider (wrist_rotation),
            and what friction there is in the joints.

    Raises:
        ConfigError: for coupled dynamics with a base that does not turn, which no rigid body can do, or a list of
            another length than the robot has joints.
    """
    viscous, coulomb = friction_by_joint(robot, config.friction)
    ignore_base_rotation = config.wrist_rotation == "parallel"
    if len(robot.stages) == 1 or config.dynamics == "coupled":
        if ignore_base_rotation and len(robot.stages) > 1:
            raise ConfigError(
                [
                    "plant.wrist_rotation: parallel leaves the rider's base unturned, which coupled rigid bodies "
                    "cannot; set plant.dynamics=decoupled, or plant.wrist_rotation=real"
                ]
            )
        arms = [ArmMotion(robot.urdf, robot.model, slice(0, robot.model.nq), viscous, coulomb)]
    else:
        arms = [
            ArmMotion(stage.urdf, stage.model, stage.joints, viscous[stage.joints], coulomb[stage.joints])
            for stage in robot.stages
        ]
    return Motion(robot, tuple(arms), ignore_base_rotation)


def friction_by_joint(robot: Robot, friction: FrictionConfig) -> tuple[FloatArray, FloatArray]:
    """Return viscous and dry friction of each joint of a robot, shapes (nq,), in N m s/rad and N m.

    Raises:
        ConfigError: for a list of another length than the robot has joints.
    """
    names = robot.model.joint_names
    viscous, coulomb = (
        np.array(expand(f"plant.friction.{key}", value, names))
        for key, value in (("viscous", friction.viscous), ("coulomb", friction.coulomb))
    )
    return viscous, coulomb
