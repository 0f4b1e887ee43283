"""Sensors of one repetition, built-in or from plug-ins."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.config.computation import computation_of
from runner.config.run import RunConfig
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
from runner.simulation.acting import CommandTiming
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.endpoint import MeasuredTip, make_measured_tips
from runner.simulation.joint_torques import make_joint_torque_sensor

_COMPUTATION = 2**32 - 4  # in the seeds; the loops' places count from 0, others are 2**32 - 3 to - 1


def make_sensors(
    closed: ClosedLoop, config: RunConfig, repetition: int
) -> tuple[
    Sequence[Encoders], WristSensor | None, TorqueSensors | None, Mapping[str, MeasuredTip], CommandTiming | None
]:
    """Make what differs between repetitions: encoders, sensors at wrist, joints and tip, and which commands act.

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
    return encoders, wrist, torques, tips, make_command_timing(closed, config, repetition)


def make_command_timing(closed: ClosedLoop, config: RunConfig, repetition: int) -> CommandTiming | None:
    """Draw which commands act in each tick of one repetition; None where all act as late as the closed loop says.

    The draws follow from (seed, repetition) and the loop's place alone, and change no other.
    """
    if closed.delay is not None:
        return None
    computation, seed = computation_of(config.plant), config.settings.seed
    rows = [
        computation.arrivals(
            late, closed.every(loop), closed.ticks + 1, np.random.default_rng([seed, repetition, _COMPUTATION, place])
        )
        for place, (loop, late) in enumerate(zip(closed.loops, config.timing.late, strict=True))
    ]
    return CommandTiming([loop.joints for loop in closed.loops], rows)


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
