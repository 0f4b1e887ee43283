"""Calibration procedures on a simulated arm with known true values: interface, bench, and poses on one point."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, Protocol

import numpy as np
from pydantic import Field, NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.base.sanitize import quoted
from runner.calibration.gravity import Tool
from runner.calibration.uncertainty import joint_deviation, pose_covariances
from runner.robots.inverse_kinematics import solve_tip_pose
from runner.robots.model import RobotModel
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, Metres, Radians
from runner.sensing.force_torque import ForceTorqueConfig


@dataclass(frozen=True)
class Outcome:
    """Result of one repetition.

    Attributes:
        estimates: In the order of the procedure's `estimates`, shape (m,).
        errors: Estimate less truth, in the order of its `errors`, shape (n,).
        covariance: Covariance of the errors by the calibration, shape (n, n).
        measures: Values of its `measures` by name.
        messages: Messages for the user.
    """

    estimates: FloatArray
    errors: FloatArray
    covariance: FloatArray
    measures: Mapping[str, float]
    messages: Sequence[str] = ()


class Procedure(Protocol):
    """One way to calibrate.

    Attributes:
        estimates: Unit of each estimate by name.
        errors: Unit of each error by name.
        measures: Unit of each measure of the poses, or of the result, by name.
        truth: True values of the estimates, shape (m,).
        postures: True joint positions in which the arm is read, shape (N, nq), in rad.
    """

    estimates: ClassVar[Mapping[str, str]]
    errors: ClassVar[Mapping[str, str]]
    measures: ClassVar[Mapping[str, str]]
    truth: FloatArray
    postures: FloatArray

    def repeat(self, generator: np.random.Generator) -> Outcome:
        """Calibrate once, with noise from a generator.

        Raises:
            ConfigError: if the postures leave something unknown.
        """
        ...


@dataclass(frozen=True)
class Bench:
    """Arm, tool and sensor of a simulated calibration.

    Attributes:
        flange: The arm, with its flange as tip.
        home: Joint positions at home, shape (nq,), in rad.
        tip: The tool centre point in the flange's frame, shape (3,), in m.
        tool: The tool in the flange's frame.
        sensor: Config of the force/torque sensor between them.
        period: Time between two readings, in s.
    """

    flange: RobotModel
    home: FloatArray
    tip: FloatArray
    tool: Tool
    sensor: ForceTorqueConfig
    period: float

    @property
    def gravity(self) -> float:
        """Magnitude of gravity along -z of the base, in m/s^2."""
        return -float(self.flange.gravity[2])

    def read_poses(
        self, postures: FloatArray, repeatability: float, generator: np.random.Generator
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flange's poses as the arm reports them, and what it knows of their errors.

        Args:
            postures: True joint positions, shape (N, nq), in rad.
            repeatability: To which the flange's position is repeated at home, in m; it becomes equal and independent
                Gaussian errors of all joints.
            generator: Source of the errors.

        Returns:
            Poses in the base frame, shape (N, 4, 4), and the covariances of position in m and rotation vector in rad,
            shape (N, 6, 6).
        """
        deviation = joint_deviation(self.flange, self.home[None], repeatability)
        reported = postures + deviation * generator.standard_normal(postures.shape)
        return self.poses(reported), pose_covariances(self.flange, reported, deviation)

    def poses(self, postures: FloatArray) -> FloatArray:
        """Return the flange's true poses, shape (N, 4, 4), at postures, shape (N, nq), in rad."""
        return np.array([self.flange.tip_pose(q) for q in postures])


class TouchingConfig(StrictModel):
    """Config of the poses.

    Attributes:
        poses: Their number.
        spread: Angle by which the flange is tilted in each, in rad.
        posture: Joint positions about which it is tilted, in rad (m for prismatic joints). The tip keeps its
            position there. None is home.
        repeatability: To which the arm repeats its flange's position at home, in m.
    """

    poses: Annotated[int, Field(ge=1, le=1000)]
    spread: Radians[Annotated[float, Field(gt=0.0, lt=np.pi)]]
    posture: JointPosition[list[float] | None]
    repeatability: Metres[NonNegativeFloat]


def touching_postures(bench: Bench, tip: FloatArray, config: TouchingConfig) -> FloatArray:
    """Return postures within the joint limits, the flange tilted about axes all around its z axis.

    Args:
        bench: The arm.
        tip: The tool centre point in the flange's frame, shape (3,), in m, which touches the same point in each.
        config: The poses wanted.

    Returns:
        Shape (poses, nq), in rad.

    Raises:
        ConfigError: if a posture has the wrong length, or the arm cannot take a pose.
    """
    middle = bench.home if config.posture is None else np.array(config.posture)
    if middle.shape != bench.home.shape:
        raise ConfigError(
            f"calibration.posture: must have {bench.home.size} values, or be null; found {quoted(config.posture)}"
        )
    central = bench.flange.tip_pose(middle)
    point = central[:3, :3] @ tip + central[:3, 3]
    postures = []
    for number in range(config.poses):
        around = 2.0 * np.pi * number / config.poses
        pose = np.eye(4)
        pose[:3, :3] = central[:3, :3] @ pin.exp3(config.spread * np.array([np.cos(around), np.sin(around), 0.0]))
        pose[:3, 3] = point - pose[:3, :3] @ tip
        try:
            postures.append(solve_tip_pose(bench.flange, pose, middle))
        except ConfigError:
            raise ConfigError(
                f"calibration.spread: {config.spread:g} rad is more than the arm can do with the tip at "
                f"{np.round(point, 4).tolist()} m: pose {number + 1} of {config.poses} is out of its reach or its "
                "joint limits; take a smaller spread, or another posture"
            ) from None
    return np.array(postures)
