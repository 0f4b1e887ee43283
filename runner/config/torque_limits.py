"""Config of the torque limits."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.config.arms import RobotOutline
from runner.schema.model import StrictModel
from runner.schema.per_joint import expand
from runner.schema.per_stage import TorquePerStage, by_stage
from runner.schema.units import JointTorque


class TorqueLimitsConfig(StrictModel):
    """Limits of the joint torques.

    Attributes:
        max: Largest magnitude of the torque, in N m; N for prismatic joints. One value for all joints, or a list with
            one for each; by stage if the robot has several. None for no limit.
    """

    max: JointTorque[TorquePerStage | None]

    def by_joint(self, arm: RobotOutline) -> FloatArray:
        """Return the limit of each joint of a robot, shape (nq,), in N m: the effort in the URDF if it is smaller.

        Raises:
            ConfigError: for values that do not fit the robot's stages and joints.
        """
        efforts = arm.effort_limits
        if self.max is None:
            return efforts
        limits: list[float] = []
        values: list[float | list[float]] = by_stage("torque_limits.max", self.max, arm.stage_names)
        for stage, value in zip(arm.stages, values, strict=True):
            key = f"torque_limits.max.{stage.name}" if len(arm.stages) > 1 else "torque_limits.max"
            limits += expand(key, value, stage.joint_names)
        return np.minimum(limits, efforts)
