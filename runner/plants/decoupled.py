"""Torque-driven plants of a robot: one coupled arm, decoupled stages as in the thesis, or flexible joints."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.plants.computation import ComputationConfig
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.flexible_joints import FlexibleJoints, SeriesElastic, links_of
from runner.plants.friction import with_friction
from runner.plants.friction_law import JointFriction, joint_friction
from runner.plants.plant import Plant
from runner.plants.servo import ServoConfig
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, StageBase
from runner.schema.model import StrictModel
from runner.schema.units import Seconds
from runner.schema.values import FrictionConfig
from runner.symbolic.bullet_step import BulletArm


class TorquePlantConfig(StrictModel):
    """Common config of plants that integrate the motion under torques.

    Attributes:
        kind: Name in the registry.
        step: Integration step, in s; None leaves the choice to the plant.
        dynamics: Whether stages act on each other (coupled) or not (decoupled); see assemble_plant.
        wrist_rotation: Whether the base stage rotates the base of the mounted stage (real) or not (parallel); see
            assemble_plant.
        friction: Friction in the joints.
        computation: Delay and misses of the controllers' torques.
        servo: Position servos of the joints, if the controller commands joint positions.
    """

    kind: str
    step: Seconds[PositiveFloat | None]
    dynamics: Literal["coupled", "decoupled"]
    wrist_rotation: Literal["real", "parallel"]
    friction: FrictionConfig
    computation: ComputationConfig
    servo: ServoConfig


@dataclass(frozen=True)
class ArmMotion:
    """An arm that moves by its own dynamics.

    Attributes:
        urdf: URDF of the arm, as a string.
        model: Model of the arm.
        joints: Joints of the arm among those of the robot.
        friction: Friction of each joint.
    """

    urdf: str
    model: RobotModel
    joints: slice
    friction: JointFriction


class BulletMotion(NamedTuple):
    """Motion of an arm by Bullet's step.

    Attributes:
        arm: The arm as Bullet has it.
        step: Step that Bullet takes, in s.
    """

    arm: BulletArm
    step: float


@dataclass(frozen=True)
class Motion:
    """The arms of a robot.

    Attributes:
        robot: The robot.
        arms: One arm for the whole robot, or one for each stage without reaction on the stage below.
        ignore_base_rotation: True if the bases of mounted stages keep their orientation at home.
        bullet: Bullet's step, which moves one arm without friction; None for the Runge-Kutta scheme.
    """

    robot: Robot
    arms: tuple[ArmMotion, ...]
    ignore_base_rotation: bool
    bullet: BulletMotion | None = None


def find_motion(robot: Robot, config: TorquePlantConfig) -> Motion:
    """Return the arms that move in a robot; a robot with one stage has one arm.

    Args:
        robot: The robot.
        config: Config of coupling (dynamics), rotation of mounted bases (wrist_rotation) and friction.

    Raises:
        ConfigError: if coupled dynamics is combined with a base that does not rotate, which rigid bodies cannot do, or
            for wrong friction; see joint_friction.
    """
    friction = joint_friction("plant.friction", config.friction, robot.model.joint_names)
    ignore_base_rotation = config.wrist_rotation == "parallel"
    if len(robot.stages) == 1 or config.dynamics == "coupled":
        if ignore_base_rotation and len(robot.stages) > 1:
            raise ConfigError(
                "plant.wrist_rotation: parallel leaves the rider's base unturned, which coupled rigid bodies "
                "cannot; set plant.dynamics=decoupled, or plant.wrist_rotation=real"
            )
        arms = [ArmMotion(robot.urdf, robot.model, slice(0, robot.model.nq), friction)]
    else:
        arms = [ArmMotion(stage.urdf, stage.model, stage.joints, friction.of(stage.joints)) for stage in robot.stages]
    return Motion(robot, tuple(arms), ignore_base_rotation)


def assemble_plant(
    config: TorquePlantConfig, robot: Robot, tick: float, make: Callable[[str, RobotModel], Plant]
) -> Plant:
    """Build the plant of a robot: one for the whole robot, or one for each stage.

    The keys `dynamics` and `wrist_rotation` have no effect on a robot with one stage.

    Args:
        config: Config of coupling (dynamics), rotation of mounted bases (wrist_rotation) and friction.
        robot: The robot.
        tick: Duration of one call of `advance`, in s.
        make: Function that builds the plant of one arm, without friction, from its URDF and model.

    Raises:
        ConfigError: see find_motion.
    """
    motion = find_motion(robot, config)
    with ExitStack() as on_error:
        plants = []
        for arm in motion.arms:
            plant = make(arm.urdf, arm.model)
            on_error.callback(plant.close)
            plants.append(with_friction(plant, arm.model, arm.friction, tick))
        whole = plants[0] if len(plants) == 1 else Decoupled(robot, plants, motion.ignore_base_rotation)
        on_error.pop_all()
    return whole


def assemble_flexible(
    config: TorquePlantConfig,
    joints: FlexibleJointsConfig,
    robot: Robot,
    step: float,
    steps_per_tick: int,
    make: Callable[[RobotModel], Plant] | None = None,
) -> Plant:
    """Build the plant of a robot with flexible joints.

    Args:
        config: Config of coupling (dynamics) and friction, which acts on the motors.
        joints: Config of springs and motors.
        robot: The robot.
        step: Integration step, in s.
        steps_per_tick: Steps in a tick.
        make: Function that builds an engine for the links from their model, with one step in a tick; None integrates
            links and motors by the Runge-Kutta scheme.

    Raises:
        ConfigError: see find_motion and FlexibleJointsConfig.by_joint.
    """
    (arm,) = find_motion(robot, config).arms
    flexibility = joints.by_joint(robot)
    links = links_of(arm.model, flexibility.flexible)
    parts = links, flexibility, step, steps_per_tick
    plant = FlexibleJoints(*parts) if make is None else SeriesElastic(make(links), *parts)
    return with_friction(plant, links, arm.friction, step * steps_per_tick)


def default_step(tick: float, stages: int) -> float:
    """Return the default step of a first-order engine, in s, if the config gives none.

    It is a tenth of the fastest controller period, or a quarter if the robot has several stages.
    """
    return tick / (10.0 if stages == 1 else 4.0)


class Decoupled(Plant):
    """Stages mounted on each other, without reaction on the stage below.

    The base of a mounted stage moves kinematically. Gravity on the stage is R^T g, updated at each tick. The motion of
    the base causes no inertial force.

    Args:
        robot: The robot.
        plants: Plant of each stage.
        ignore_base_rotation: True if the bases of mounted stages keep their orientation at home.
    """

    def __init__(self, robot: Robot, plants: Sequence[Plant], ignore_base_rotation: bool) -> None:
        self.q = np.zeros(robot.model.nq)
        self.dq = np.zeros(robot.model.nq)
        self._plants = plants
        self._joints = [stage.joints for stage in robot.stages]
        self._bases = [StageBase(robot, index, ignore_base_rotation) for index in range(1, len(robot.stages))]
        self._gravity = robot.model.gravity

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arms to a state; see Plant."""
        for plant, joints in zip(self._plants, self._joints, strict=True):
            plant.reset(q[joints], dq[joints])
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._gravity = gravity
        self._plants[0].set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        for plant, base in zip(self._plants[1:], self._bases, strict=True):
            base.update(self.q, self.dq)
            plant.set_gravity(base.rotation.T.dot(self._gravity))
        for plant, joints in zip(self._plants, self._joints, strict=True):
            plant.advance(tau[joints])
            self.q[joints], self.dq[joints] = plant.q, plant.dq

    @property
    def friction(self) -> FloatArray:
        """Friction of all plants; see Plant."""
        return np.concatenate([plant.friction for plant in self._plants])

    def close(self) -> None:
        """Release the resources of the plants."""
        for plant in self._plants:
            plant.close()
