"""Calibration bench: an arm with tool and sensor, and their true values."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.calibration.tool import Tool
from runner.calibration.uncertainty import joint_deviation, pose_covariances
from runner.robots.model import RobotModel
from runner.sensing.force_torque import ForceTorqueConfig


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
