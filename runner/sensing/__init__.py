"""Sensors: encoders, joint torques, wrist force/torque and tip position."""

from runner.sensing.encoders import EncoderNoise, JointEncoders, NoiseConfig, encoder_errors
from runner.sensing.endpoint import EndpointSensorConfig
from runner.sensing.force_torque import ForceTorqueConfig, ForceTorqueSensor
from runner.sensing.joint_torque import JointTorqueConfig, JointTorqueSensor
from runner.sensing.kinds import JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS, Encoders, TorqueSensors, WristSensor

__all__ = [
    "JOINT_TORQUE_SENSORS",
    "NOISES",
    "WRIST_SENSORS",
    "EncoderNoise",
    "Encoders",
    "EndpointSensorConfig",
    "ForceTorqueConfig",
    "ForceTorqueSensor",
    "JointEncoders",
    "JointTorqueConfig",
    "JointTorqueSensor",
    "NoiseConfig",
    "TorqueSensors",
    "WristSensor",
    "encoder_errors",
]
