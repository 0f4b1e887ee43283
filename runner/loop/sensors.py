"""What measures in one repetition: ours, and plug-ins in their place."""

from collections.abc import Sequence

import numpy as np

from runner.assembly import make_encoders, make_wrist_sensor
from runner.config.run import RunConfig
from runner.loop.closed_loop import ClosedLoop
from runner.loop.joint_torques import make_joint_torque_sensor
from runner.sensing import NOISES, WRIST_SENSORS, Encoders, TorqueSensors, WristSensor


def make_sensors(
    closed: ClosedLoop, config: RunConfig, repetition: int
) -> tuple[Sequence[Encoders], WristSensor | None, TorqueSensors | None]:
    """Make the joint measurement of each loop, and the sensors at the wrist and in the joints, where there are any.

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
    return encoders, wrist, make_joint_torque_sensor(closed, config, repetition)
