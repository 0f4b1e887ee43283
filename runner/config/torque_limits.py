"""Config of the torque limits."""

from runner.config.per_stage import TorquePerStage
from runner.registry import StrictModel


class TorqueLimitsConfig(StrictModel):
    """Limits of the joint torques.

    Attributes:
        max: Largest magnitude of the torque, in N m: one for all joints, or a list with one for each, by stage where
            the robot has several; None is no limit.
    """

    max: TorquePerStage | None
