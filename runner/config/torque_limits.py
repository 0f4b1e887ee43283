"""Config of the torque limits, and the limits of each joint."""

import numpy as np

from runner.base.errors import ConfigError
from runner.config.arms import RobotOutline
from runner.plants.motor_limits import TorqueLimits
from runner.robots.robot import by_joint
from runner.schema.model import StrictModel
from runner.schema.units import JointSpeed, JointTorque
from runner.schema.values import SpeedPerStage, TorquePerStage


class TorqueLimitsConfig(StrictModel):
    """Limits of the joint torques.

    Attributes:
        max: Largest magnitude of the torque, in N m; N for prismatic joints. One value for all joints, or a list with
            one for each; by stage if the robot has several. None for no limit.
        no_load_speed: Speed at which a driving motor has no torque left, in rad/s; m/s for prismatic joints. In the
            form of max; None for a limit that is the same at every speed.
    """

    max: JointTorque[TorquePerStage | None]
    no_load_speed: JointSpeed[SpeedPerStage]

    def by_joint(self, arm: RobotOutline) -> TorqueLimits:
        """Return the limits of each joint of a robot, with the effort in the URDF if it is smaller than max.

        Raises:
            ConfigError: for values that do not fit the robot's stages and joints, and a speed without a torque.
        """
        most = np.minimum(by_joint("torque_limits.max", self.max, arm.stage_joints), arm.effort_limits)
        speed = by_joint("torque_limits.no_load_speed", self.no_load_speed, arm.stage_joints)
        joints = [joint for own in arm.stage_joints.values() for joint in own]
        endless = [
            name for name, torque, own in zip(joints, most, speed, strict=True) if own < np.inf and torque == np.inf
        ]
        if endless:
            raise ConfigError(
                f"torque_limits.no_load_speed: needs a torque limit; none for {', '.join(endless)}. Set "
                "torque_limits.max"
            )
        return TorqueLimits(most, speed)
