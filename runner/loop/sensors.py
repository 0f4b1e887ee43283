"""What measures in one repetition: ours, and plug-ins in their place."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.config.run import RunConfig
from runner.loop.closed_loop import ClosedLoop
from runner.loop.endpoint import MeasuredTip, make_measured_tips
from runner.loop.joint_torques import make_joint_torque_sensor
from runner.sensing import (
    NOISES,
    WRIST_SENSORS,
    EncoderNoise,
    Encoders,
    ForceTorqueConfig,
    ForceTorqueSensor,
    JointEncoders,
    TorqueSensors,
    WristSensor,
)


def make_sensors(
    closed: ClosedLoop, config: RunConfig, repetition: int
) -> tuple[Sequence[Encoders], WristSensor | None, TorqueSensors | None, Mapping[str, MeasuredTip]]:
    """Make the joint measurement of each loop, and the sensors at wrist, joints and tip, where there are any.

    Those of plug-ins get random numbers from the same seeds as ours.
    """
    seed, plugged = config.settings.seed, config.plugged
    encoders: Sequence[Encoders] = make_encoders(closed, config.noise, seed, repetition)
    if "noise" in plugged:
        joints = closed.robot.model.joint_names
        encoders = [
            NOISES.build(
                plugged["noise"],
                joints,
                closed.ticks // closed.every(loop) + 1,
                loop.period,
                np.random.default_rng([seed, repetition, place]),
            )
            for place, loop in enumerate(closed.loops)
        ]
    wrist: WristSensor | None = make_wrist_sensor(closed, config.wrist_sensor, seed, repetition)
    if wrist is not None and "wrist_sensor" in plugged:
        generator = np.random.default_rng([seed, repetition, len(closed.loops)])
        wrist = WRIST_SENSORS.build(plugged["wrist_sensor"], closed.ticks + 1, closed.tick, generator)
    torques, tips = make_joint_torque_sensor(closed, config, repetition), make_measured_tips(closed, config, repetition)
    return encoders, wrist, torques, tips


def make_encoders(closed: ClosedLoop, noise: EncoderNoise, seed: int, repetition: int) -> list[JointEncoders]:
    """Make our joint measurement of each loop for one repetition.

    Its noise follows from (seed, repetition) and the loop's place alone: however long a run or another loop's period
    is, it starts alike, so that runs can be compared in pairs.
    """
    return [
        JointEncoders(
            closed.ticks // closed.every(loop) + 1,
            loop.period,
            noise,
            np.random.default_rng([seed, repetition, place]),
        )
        for place, loop in enumerate(closed.loops)
    ]


def make_wrist_sensor(
    closed: ClosedLoop, sensor: ForceTorqueConfig, seed: int, repetition: int
) -> ForceTorqueSensor | None:
    """Make our force/torque sensor for one repetition, where there is something to feel; noise as for the encoders."""
    if closed.interaction is None:
        return None
    generator = np.random.default_rng([seed, repetition, len(closed.loops)])
    return ForceTorqueSensor(closed.ticks + 1, closed.tick, sensor, generator)
