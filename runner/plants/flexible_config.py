"""Config of flexible joints: springs between motors and links."""

from typing import Literal, Protocol

import numpy as np
from pydantic import NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, nearest
from runner.base.sanitize import quoted
from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import links_of
from runner.robots.robot import Robot, by_joint
from runner.robots.vibration import Mode, find_modes
from runner.schema.model import StrictModel
from runner.schema.units import MomentOfInertia, RotaryStiffness, Seconds
from runner.schema.values import SpringPerStage


class FlexibleJointsConfig(StrictModel):
    """Config of flexible joints; by stage if the robot has several.

    Attributes:
        stiffness: Stiffness between motor and link, in N m/rad. One value for all joints or a list with one for each;
            None for a rigid joint.
        motor_inertia: Inertia of the motor after its gear, in kg m^2. One value for all joints or a list with one for
            each. None selects `robot.armature` for a joint with a spring, and no motor for a rigid joint.
        damping_ratio: Damping ratio of each joint's spring with its link, the other joints held at home: 1 is critical.
        torsion_damping: Damping ratio that the drives add to each motor on its spring with the link held, from encoders
            at motor and link: the fast part of Spong's composite control. 0 adds none.
        brake_time: Time at which the brakes of a stage's motors close, in s, by stage; 0 is from the start. The brakes
            of a stage that is not named stay open.
        encoders: Location of the encoders: at the motors or at the links.
        static_deflection: Whether motor readings are corrected for the deflection under the nominal weight (known) or
            not (unknown).
    """

    stiffness: RotaryStiffness[SpringPerStage]
    motor_inertia: MomentOfInertia[SpringPerStage]
    damping_ratio: NonNegativeFloat
    torsion_damping: NonNegativeFloat
    brake_time: Seconds[dict[str, NonNegativeFloat]]
    encoders: Literal["motor", "link"]
    static_deflection: Literal["known", "unknown"]

    def by_joint(self, arm: Robot) -> Flexibility:
        """Return springs, dampers and motors of a robot's joints.

        Raises:
            ConfigError: if values do not fit the robot's stages and joints, no joint has a spring, a joint with a
                spring has no motor or has both a motor and an armature, a joint has a motor without a spring, or a
                prismatic joint has a spring.
        """
        springs = by_joint("plant.flexible_joints.stiffness", self.stiffness, arm.stage_joints)
        motors = by_joint("plant.flexible_joints.motor_inertia", self.motor_inertia, arm.stage_joints)
        key, flexible, given = "plant.flexible_joints", np.isfinite(springs), np.isfinite(motors)
        problems = []
        if not flexible.any():
            problems.append(f"{key}.stiffness: null for every joint; take plant.flexible_joints=null for a rigid arm")
        for name, spring, motor, armature, prismatic in zip(
            arm.model.joint_names, flexible, given, arm.model.armature, arm.model.prismatic, strict=True
        ):
            if spring and not motor and not armature:
                problems.append(
                    f"{key}.motor_inertia: null takes robot.armature, which is 0 for {name}; give one of both"
                )
            if spring and motor and armature:
                problems.append(
                    f"{key}.motor_inertia: {name} has robot.armature={armature:g}, too, and both are its motor; give "
                    "null here, or robot.armature=0"
                )
            if motor and not spring:
                problems.append(f"{key}.motor_inertia: {name} has a motor and no spring; give null, or a stiffness")
            if spring and prismatic:
                problems.append(f"{key}.stiffness: {name} slides; springs are for joints that turn, so null")
        if problems:
            raise ConfigError(problems)
        motors = np.where(flexible, np.where(given, motors, arm.model.armature), 0.0)
        held = np.diag(links_of(arm.model, flexible).mass_matrix(arm.home))
        damping, torsion_feedback = np.zeros((2, len(springs)))
        damping[flexible] = 2.0 * self.damping_ratio * np.sqrt(springs[flexible] * held[flexible])
        torsion_feedback[flexible] = 2.0 * self.torsion_damping * np.sqrt(springs[flexible] * motors[flexible])
        return Flexibility(springs, motors, damping, self._find_brake_time(arm, flexible), torsion_feedback)

    def _find_brake_time(self, arm: Robot, flexible: np.ndarray) -> FloatArray:
        """Return the time at which each joint is braked, shape (nq,), in s."""
        brake_time, stages, key = np.full(len(flexible), np.inf), arm.stage_names, "plant.flexible_joints.brake_time"
        problems = []
        for name, time in self.brake_time.items():
            if name not in stages:
                problems.append(
                    f"{key}: no such stage: {quoted(name)}{nearest(name, stages)}; stages: {', '.join(stages)}"
                )
                continue
            joints = arm.stages[stages.index(name)].joints
            if not flexible[joints].all():
                problems.append(f"{key}: {name} has rigid joints, whose motors are links; give each of them a spring")
            brake_time[joints] = time
        if problems:
            raise ConfigError(problems)
        return brake_time


class HasFlexibleJoints(Protocol):
    """Config of a plant whose joints may be flexible."""

    @property
    def flexible_joints(self) -> FlexibleJointsConfig | None:
        """Springs between motors and links; None for rigid joints."""
        ...


def modes(config: HasFlexibleJoints, robot: Robot, q: FloatArray) -> list[Mode]:
    """Return the modes of flexible joints about a configuration, motors held; none for rigid joints; see find_modes."""
    if config.flexible_joints is None:
        return []
    flexibility = config.flexible_joints.by_joint(robot)
    on = flexibility.flexible
    M = links_of(robot.model, on).mass_matrix(q)[np.ix_(on, on)]
    return find_modes(M, np.diag(flexibility.damping[on]), np.diag(flexibility.stiffness[on]))
