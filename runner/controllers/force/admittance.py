"""Admittance control of a position-controlled arm: mass, damper and spring at the tool."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.controllers.controller import Loop, PositionController
from runner.controllers.force.admittance_filter import Admittance, AdmittanceFilter
from runner.controllers.force.force_reading import Compensation, ToolCompensation
from runner.controllers.kinematic.limited_motion import Approach, LimitedMotion
from runner.controllers.operational_space.tip_task import task_start
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import AxisDamping, AxisInertia, AxisStiffness, MetresPerSecond, PerSecond, Seconds
from runner.sensing.force_torque import ForceTorqueConfig

COMMANDS = "position"
Six = Annotated[list[float], Field(min_length=6, max_length=6)]


class AdmittanceConfig(StrictModel):
    """Config of admittance control; lists have translation along and rotation about x, y, z of the base.

    Attributes:
        kind: Registry name of the controller.
        period: Time between two commands, in s.
        mass: M, in kg and kg m^2.
        damping: B, in N s/m and N m s/rad.
        stiffness: K, in N/m and N m/rad; 0 lets an axis be guided by hand.
        wrench_frame: Reference point of the wrench: the tool's tip or the flange.
        compensation: Loads subtracted from the sensor reading: none, bias and tool weight, or also the tool's inertia.
        tip_speed: Maximum speed of the spring's rest position towards a goal that jumps, in m/s.
        limit_approach: Maximum speed of a joint towards its position limit, per distance to it, in 1/s.
        sensor: Nominal config of the wrist sensor: bias, rotation and height.
        check_stability: True if a wall is rejected on which the sampled law would bounce with ideal joints, such as
            those of a kinematic plant. With servos no wall is rejected; the caveat unstable_contact reports it.
    """

    kind: Literal["admittance"]
    period: Seconds[PositiveFloat]
    mass: AxisInertia[Six]
    damping: AxisDamping[Six]
    stiffness: AxisStiffness[Six]
    wrench_frame: Literal["tip", "flange"]
    compensation: Compensation
    tip_speed: MetresPerSecond[PositiveFloat]
    limit_approach: PerSecond[PositiveFloat]
    sensor: ForceTorqueConfig
    check_stability: bool

    @property
    def law(self) -> Admittance:
        """The law of each axis."""
        return Admittance(np.array(self.mass), np.array(self.damping), np.array(self.stiffness))


class AdmittanceControl(PositionController):
    r"""The law of AdmittanceFilter around a desired motion, for a position-controlled arm.

    .. math:: M \ddot e + B \dot e + K e = f, \qquad x_c = x_d + e

    f is the external wrench from the wrist sensor, about the tip (Meca500 report, sections 4 to 6), so a force through
    the tip causes no rotation; wrench_frame and compensation can change this. The orientation is that of home, rotated
    by e. If the joints cannot follow, at their limits or near a singular configuration, the filter is set to the pose
    and velocity of the arm and so stays stable; `messages` reports when this happened.

    Args:
        robot: The robot.
        config: Config of the law.
    """

    def __init__(self, robot: Robot, config: AdmittanceConfig) -> None:
        self._config = config
        self._filter = AdmittanceFilter(config.law, config.period)
        self._motion = LimitedMotion(robot.model, config.period, config.limit_approach)
        self._compensation = ToolCompensation(robot, config.sensor, config.compensation, config.period)
        self._at_tip = config.wrench_frame == "tip"
        self._orientation = robot.model.tip_pose(robot.home)[:3, :3]
        self._reading = np.zeros(6)
        self._approach = Approach(config.period, config.tip_speed)
        self.external_wrench = np.zeros(6)

    def reset(self, q: FloatArray) -> None:
        """Start at rest at the arm's configuration; see PositionController."""
        self._filter.reset()
        self._motion.reset(q)
        self._compensation.reset()
        self._approach.reset(self._motion.tip.translation)
        self._reading, self.external_wrench = np.zeros(6), np.zeros(6)

    def update_wrench(self, reading: FloatArray) -> None:
        """Store the wrist sensor's reading; see WrenchFeedbackController."""
        self._reading = reading

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the next command; see PositionController.joint_positions."""
        at_tip, at_flange = self._compensation.external(q, dq, self._reading)
        self.external_wrench = at_tip
        translation, rotation = self._filter.translation, self._filter.rotation
        self._filter.step(at_tip if self._at_tip else at_flange)
        rest = self._approach.follow(reference[0] + self._config.period * reference[1])
        wanted = pin.SE3(self._filter.rotation @ self._orientation, rest + self._filter.translation)
        command, reached = self._motion.follow(time, wanted)
        if not self._motion.free:
            held, turned = reached.translation - rest, reached.rotation @ self._orientation.T
            way = np.concatenate([held - translation, pin.log3(turned @ rotation.T)])
            self._filter.place(held, turned, way / self._config.period)  # keeps the arm's velocity
        return command

    def messages(self) -> list[str]:
        """Return the joint limits and singularities that held the tool back; see WrenchFeedbackController."""
        return self._motion.messages()


CONFIG = AdmittanceConfig


def build(config: AdmittanceConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the single loop of a config; it commands every joint.

    Raises:
        ConfigError: if the arm has fewer than six joints, or the law is not valid; see Admittance.
    """
    controller = AdmittanceControl(robot, config)
    return (Loop(robot.stage_names[-1], slice(0, robot.model.nq), config.period, controller, uses_wrench=True),)


def start_posture(config: AdmittanceConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return the joint positions at the start, with the orientation of home; see task_start."""
    return task_start("pose", robot, start)
