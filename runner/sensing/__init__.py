"""What the controllers are told of the true motion."""

from runner.sensing.encoders import EncoderNoise, JointEncoders, encoder_errors
from runner.sensing.force_torque import ForceTorqueConfig, ForceTorqueSensor
from runner.sensing.joint_torque import JointTorqueConfig, JointTorqueSensor

__all__ = [
    "EncoderNoise",
    "ForceTorqueConfig",
    "ForceTorqueSensor",
    "JointEncoders",
    "JointTorqueConfig",
    "JointTorqueSensor",
    "encoder_errors",
]
