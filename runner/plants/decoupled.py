"""Torque-driven plants of a robot: one coupled arm, or decoupled stages as in the thesis."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.plants.computation import ComputationConfig
from runner.plants.friction import with_friction
from runner.plants.plant import Plant
from runner.plants.servo import ServoConfig
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, StageBase
from runner.schema.model import StrictModel
from runner.schema.units import Seconds
from runner.schema.values import FrictionConfig, expand


class TorquePlantConfig(StrictModel):
    """What the configs of plants have in common that integrate the motion under torques.

    Attributes:
        kind: Its name in the registry.
        step: Integration step, in s; None is chosen by the plant.
        dynamics: Whether stages that ride on each other act on each other; see assemble_plant.
        wrist_rotation: Whether the carrier turns the rider's base; see assemble_plant.
        friction: Friction in the joints.
        computation: What a computer does to the controllers' torques: how late they act, and which are missed.
        servo: The joints' position servos, where the controller commands joint positions.
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


def find_motion(robot: Robot, config: TorquePlantConfig) -> Motion:
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
                "plant.wrist_rotation: parallel leaves the rider's base unturned, which coupled rigid bodies "
                "cannot; set plant.dynamics=decoupled, or plant.wrist_rotation=real"
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


def assemble_plant(
    config: TorquePlantConfig, robot: Robot, tick: float, make: Callable[[str, RobotModel], Plant]
) -> Plant:
    """Make a plant for a robot: of the whole, or of its stages each for itself.

    A robot of one stage has nothing to couple, and both keys no effect.

    Args:
        config: Says whether stages act on each other (dynamics), whether a carrier turns its rider (wrist_rotation),
            and what friction there is in the joints.
        robot: The robot.
        tick: Time that one `advance` takes, in s.
        make: Makes the plant of one arm, without friction, from its URDF text and model.

    Raises:
        ConfigError: see find_motion.
    """
    motion = find_motion(robot, config)
    with ExitStack() as on_error:
        plants = []
        for arm in motion.arms:
            plant = make(arm.urdf, arm.model)
            on_error.callback(plant.close)
            plants.append(with_friction(plant, arm.model, arm.viscous, arm.coulomb, tick))
        whole = plants[0] if len(plants) == 1 else Decoupled(robot, plants, motion.ignore_base_rotation)
        on_error.pop_all()
    return whole


def default_step(tick: float, stages: int) -> float:
    """Return the step of an engine of first order if the config gives none, in s.

    It is a tenth of the fastest controller period, or a quarter if the robot has several stages.
    """
    return tick / (10.0 if stages == 1 else 4.0)


class Decoupled(Plant):
    """Arms that ride on each other without feeling it.

    A carrier feels no rider. A rider's base is carried kinematically: it feels gravity as R^T g, renewed at each tick,
    and no inertial force of its base's motion.

    Args:
        robot: The robot.
        plants: The plant of each stage.
        ignore_base_rotation: Whether riders' bases keep their orientation of home.
    """

    def __init__(self, robot: Robot, plants: Sequence[Plant], ignore_base_rotation: bool) -> None:
        self.q = np.zeros(robot.model.nq)
        self.dq = np.zeros(robot.model.nq)
        self._plants = plants
        self._joints = [stage.joints for stage in robot.stages]
        self._bases = [StageBase(robot, index, ignore_base_rotation) for index in range(1, len(robot.stages))]
        self._gravity = robot.model.gravity

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arms into a state; see Plant."""
        for plant, joints in zip(self._plants, self._joints, strict=True):
            plant.reset(q[joints], dq[joints])
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector; see Plant."""
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
        """Release what the plants hold."""
        for plant in self._plants:
            plant.close()
