"""Position control of the xArm7 with three joints, by closed-form inverse kinematics."""

from typing import Literal

from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Loop, PositionController
from runner.papers.studies.xarm7.parts.three_joint_kinematics import Branch, ThreeJointArm
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import Radians, Seconds

COMMANDS = "position"
FOLLOWS_PATHS = True
_SIGNS = {"front": 1, "back": -1, "plus": 1, "minus": -1}


class ThreeJointConfig(StrictModel):
    """Config of three-joint control.

    Attributes:
        kind: Its name in the registry.
        period: Time between two commands, in s.
        wrist: q6, in rad.
        shoulder: Whether the arm faces the point, or turns its back and reaches over.
        elbow: Sign of the root in q4.
        feedforward: Whether a command aims at where the desired tip will be a period later.
    """

    kind: Literal["three_joint"]
    period: Seconds[PositiveFloat]
    wrist: Radians[float]
    shoulder: Literal["front", "back"]
    elbow: Literal["plus", "minus"]
    feedforward: bool

    @property
    def branch(self) -> Branch:
        """The branch of the inverse kinematics."""
        return Branch(_SIGNS[self.shoulder], _SIGNS[self.elbow])


class ThreeJoint(PositionController):
    """Joints 1, 2 and 4 from the desired tip position; joints 3, 5, 7 stay at zero and joint 6 where it is put.

    It is open loop: what is measured has no influence. Without feedforward the arm is a period late, as a command
    is reached by the next one; with it, the desired motion is extrapolated over that period to second order.

    Args:
        arm: The arm's inverse kinematics.
        config: The law's numbers.
    """

    def __init__(self, arm: ThreeJointArm, config: ThreeJointConfig) -> None:
        self._arm = arm
        self._branch = config.branch
        self._ahead = config.period if config.feedforward else 0.0

    def reset(self, q: FloatArray) -> None:
        """Do nothing: the law has no memory."""

    def joint_positions(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the posture for the desired tip; see PositionController.joint_positions."""
        h = self._ahead
        return self._arm.solve(reference[0] + h * reference[1] + 0.5 * h * h * reference[2], self._branch)


CONFIG = ThreeJointConfig


def build(config: ThreeJointConfig, robot: Robot) -> tuple[Loop, ...]:
    """Make the one loop that a config describes.

    Raises:
        ConfigError: if the arm's chain is not the xArm7's.
    """
    controller = ThreeJoint(ThreeJointArm(robot.model, config.wrist), config)
    return (Loop(robot.stage_names[-1], slice(0, robot.model.nq), config.period, controller),)


def start_posture(config: ThreeJointConfig, robot: Robot, start: FloatArray) -> FloatArray:
    """Return the initial joint positions, by the three joints.

    Raises:
        numpy.linalg.LinAlgError: if the start cannot be reached.
    """
    return ThreeJointArm(robot.model, config.wrist).solve(start, config.branch)
