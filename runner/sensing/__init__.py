"""Sensors: encoders, joint torques, wrist force/torque and tip position."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.plugins.features import Features, read_features
from runner.plugins.guard import Asked, Guard, Method, array, checked, like, place
from runner.plugins.registry import KindConfig, Registry
from runner.sensing.endpoint import TipSensorConfig


class Encoders(Protocol):
    """Joint measurement of one control loop."""

    def measure(self, tick: int, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return measured joint positions and velocities from the true ones.

        Args:
            tick: Index of the measurement, from 0.
            q: True joint positions, shape (nq,), in rad; m for prismatic joints.
            dq: True joint velocities, shape (nq,), in rad/s; m/s for prismatic joints.
        """
        ...


class WristSensor(Protocol):
    """Force/torque sensor between flange and tool."""

    def read(self, tick: int, wrench: FloatArray) -> FloatArray:
        """Return the reading of a load on the flange; see ForceTorqueSensor.read."""
        ...


class TorqueSensors(Protocol):
    """Torque sensors in the joints."""

    def read(self, tick: int, torque: FloatArray) -> FloatArray:
        """Return the readings of the mean torques on the links; see JointTorqueSensor.read."""
        ...


class TipSensor(Protocol):
    """Sensor of the tip of one control loop."""

    def measure(self, number: int, tip: FloatArray) -> FloatArray:
        """Return the measured position and velocity of the tip, shape (2, 3), in m and m/s.

        Args:
            number: Index of the measurement, from 0.
            tip: True position and velocity of the tip in the base frame, shape (2, 3), in m and m/s.
        """
        ...


def _check_measurement(
    answer: Any, asked: Asked, _: int, q: FloatArray, dq: FloatArray
) -> tuple[FloatArray, FloatArray]:
    if not isinstance(answer, tuple | list) or len(answer) != 2:
        at = place(asked.part.measure)
        raise SimulationError(f"{at} gave {answer!r:.200}; it must be positions and velocities")
    return checked(answer[0], q.shape, asked), checked(answer[1], dq.shape, asked)


@dataclass(frozen=True)
class SensorFeatures(Features):
    """Optional members of the module of a sensor in the joints.

    Attributes:
        by_joint: Function of the config and of the unit of each joint by name, by stage. It returns the values of each
            joint, with the kind, from which `build` makes the sensors, or None for no sensors. The default returns the
            config.
    """

    by_joint: Callable[[Any, Mapping[str, Mapping[str, str]]], Any] = lambda config, units: config


NOISES = Registry[KindConfig, [tuple[str, ...], int, float, np.random.Generator], Encoders](
    "noise",
    {"encoders": "runner.sensing.encoders"},
    Guard("noise", measure=Method(_check_measurement)),
    default="encoders",
)
"""`build` takes the joint names, the number of measurements, the time between two in s, and a random generator."""

WRIST_SENSORS = Registry[KindConfig, [int, float, np.random.Generator], WristSensor](
    "wrist_sensor",
    {"force_torque": "runner.sensing.force_torque"},
    Guard("wrist_sensor", read=Method(like(1))),
    default="force_torque",
)
"""`build` takes the number of readings, the time between two in s, and a random generator."""

JOINT_TORQUE_SENSORS = Registry[KindConfig, [tuple[str, ...], int, np.random.Generator], TorqueSensors](
    "joint_torque_sensor",
    {"joint_torque": "runner.sensing.joint_torque"},
    Guard("joint_torque_sensor", read=Method(like(1))),
    default="joint_torque",
)
"""`build` takes the joint names, the number of readings, and a random generator."""


class TipSensors(Registry[KindConfig, [int, float, np.random.Generator], TipSensor]):
    """The kinds of tip sensors."""

    base = TipSensorConfig


ENDPOINT_SENSORS = TipSensors(
    "endpoint_sensor",
    {"endpoint": "runner.sensing.endpoint"},
    Guard("endpoint_sensor", measure=Method(array(2, 3))),
    default="endpoint",
)
"""`build` takes the number of measurements, the time between two in s, and a random generator."""


def values_by_joint(group: str, sensor: KindConfig, units: Mapping[str, Mapping[str, str]]) -> KindConfig | None:
    """Return the values of each joint's sensor, None without sensors; see SensorFeatures.

    Args:
        group: "noise" or "joint_torque_sensor".
        sensor: Config of the sensors.
        units: Unit of the position of each joint by name, rad or m, by stage.

    Raises:
        ConfigError: for values that do not fit the robot.
    """
    kinds: Registry[KindConfig, ..., Any] = NOISES if group == NOISES.group else JOINT_TORQUE_SENSORS
    features: SensorFeatures = read_features(SensorFeatures, kinds.module(sensor.kind))
    found: KindConfig | None = kinds.ask(sensor, features.by_joint, units)
    return found
