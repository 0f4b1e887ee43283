"""What the controllers are told of the true motion."""

from runner.sensing.encoders import EncoderNoise, JointEncoders, encoder_errors
from runner.sensing.force_torque import ForceTorqueConfig, ForceTorqueSensor

__all__ = ["EncoderNoise", "ForceTorqueConfig", "ForceTorqueSensor", "JointEncoders", "encoder_errors"]
