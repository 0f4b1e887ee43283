"""What the controllers are told of the true motion."""

from runner.sensing.encoders import JointEncoders
from runner.sensing.force_torque import ForceTorqueConfig, ForceTorqueSensor

__all__ = ["ForceTorqueConfig", "ForceTorqueSensor", "JointEncoders"]
