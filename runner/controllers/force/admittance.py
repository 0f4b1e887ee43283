"""Admittance control of a position-controlled arm: mass, damper and spring at the tool."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.controllers.controller import Loop, PositionController
from runner.controllers.force.admittance_filter import Admittance, AdmittanceFilter
from runner.controllers.force.wrist import Compensation, ToolCompensation
from runner.controllers.kinematic.limited_motion import Approach, LimitedMotion
from runner.controllers.operational_space.tip_task import task_start
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import AxisDamping, AxisInertia, AxisStiffness, MetresPerSecond, PerSecond, Seconds
from runner.sensing.force_torque import ForceTorqueConfig

COMMANDS = "position"
Six = Annotated[list[float], Field(min_length=6, max_length=6)]


class AdmittanceConfig(StrictModel):
    """Config of admittance control; lists hold translation along x, y, z and rotation about them, of the base.

    Attributes:
        kind: Registry name of the controller.
        period: Time between two commands, in s.
        mass: M, in kg and kg m^2.
        damping: B, in N s/m and N m s/rad.
        stiffness: K, in N/m and N m/rad; 0 lets an axis be guided by hand.
        wrench_frame: Where the wrench is taken to act: at the tool's tip, or at the flange.
        compensation: What is taken off the sensor's reading: its bias, and the tool's weight, and its inertia.
        tip_speed: Largest speed at which the spring's rest goes to a goal that jumps, in m/s.
        limit_approach: How fast a joint may near its position limit, as a share of what is left, in 1/s.
        sensor: What is believed of the wrist's sensor: its bias, rotation and height.
        check_stability: Whether a wall is refused that the sampled law would bounce on with ideal joints, as those of a
            kinematic plant; behind servos nothing is refused, and a caveat tells (unstable_contact).
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
    r"""The law of AdmittanceFilter around a desired motion, led by a position-controlled arm.

    .. math:: M \ddot e + B \dot e + K e = f, \qquad x_c = x_d + e

    f is what the wrist's sensor feels of the world, its bias and the tool off, seen from the tip (Meca500 report,
    sections 4 to 6), so that a force through the tip turns nothing. Orientation: that of home, turned by e. Where the
    joints cannot follow, at their limits or at a singular posture, the filter is put where the arm is, as fast as
    it is, and stays stable there; `messages` reports when it was.

    Args:
        robot: The robot.
        config: The law's numbers.
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
        """Rest where the arm stands; see PositionController."""
        self._filter.reset()
        self._motion.reset(q)
        self._compensation.reset()
        self._approach.reset(self._motion.tip.translation)
        self._reading, self.external_wrench = np.zeros(6), np.zeros(6)

    def update_wrench(self, reading: FloatArray) -> None:
        """Take the wrist sensor's reading; see WrenchFeedbackController."""
        self._reading = reading

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the next command; see PositionController.joint_positions."""
        at_tip, at_flange = self._compensation.external(q, dq, self._reading)
        self.external_wrench = at_tip
        translation, rotation = self._filter.translation, self._filter.rotation
        self._filter.step(at_tip if self._at_tip else at_flange)
        rest = self._approach.follow(reference[0] + self._config.period * reference[1])
        wanted = pin.SE3(self._filter.rotation @ self._orientation, rest + self._filter.translation)
        command, reached = self._motion.lead(time, wanted)
        if not self._motion.free:
            held, turned = reached.translation - rest, reached.rotation @ self._orientation.T
            way = np.concatenate([held - translation, pin.log3(turned @ rotation.T)])
            self._filter.place(held, turned, way / self._config.period)  # as fast as the arm: it slows, not stops
        return command

    def messages(self) -> list[str]:
        """Return where joints or the reach have held the tool back; see WrenchFeedbackController."""
        return self._motion.messages()


CONFIG = AdmittanceConfig


def build(config: AdmittanceConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the single loop of a config; it commands every joint.

    Raises:
        ConfigError: for an arm of fewer than six joints, or a law that no mass on a damper and a spring has.
    """
    controller = AdmittanceControl(robot, config)
    return (Loop(robot.stage_names[-1], slice(0, robot.model.nq), config.period, controller, uses_wrench=True),)


def start_posture(config: AdmittanceConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return where the arm starts: at home's orientation."""
    return task_start("pose", robot, start)
