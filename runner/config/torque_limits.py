"""Config of the torque limits."""

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
