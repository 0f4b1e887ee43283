"""What the controllers are told of the true motion."""

from runner.sensing.encoders import JointEncoders

__all__ = ["JointEncoders"]
