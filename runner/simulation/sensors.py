"""Sensors of one repetition: encoders, and sensors at wrist, joints and tip, built-in or from plug-ins."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.cross_checks import endpoint_ticks
from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.controllers.controller import ControlLaw
from runner.plants import Plant, options_of
from runner.plugins.registry import KindConfig
from runner.robots.model import RobotModel
from runner.sensing import (
    ENDPOINT_SENSORS,
    JOINT_TORQUE_SENSORS,
    NOISES,
    WRIST_SENSORS,
    Encoders,
    TipSensor,
    TorqueSensors,
    WristSensor,
)
from runner.sensing.endpoint import EndpointTicks
from runner.sensing.streams import COMPUTATION, JOINT_TORQUES, TIP
from runner.simulation.recorder import CommandTiming


class MeasuredTip:
    r"""Correction of a control loop's desired motion, so that it tracks the measured tip instead of the encoders' tip.

    .. math:: \Delta = y - p(\hat q), \qquad \dot\Delta = \dot y - J(\hat q) \hat{\dot q}

    If a control law moves the tip according to the encoders to x_d - Delta, the measured tip is at x_d. So every law
    can use the sensor, and the measurement corrects any bending between encoders and tip. Measurement and encoders
    refer to the same instant. Their difference is available after the delay and is constant until the next one; it is 0
    before the first one.

    Args:
        sensor: The sensor, with a draw for each measurement.
        times: Times of the measurements.
        plant: The plant, for the true tip.
        true: Model of the true robot.
        nominal: Nominal model.
    """

    def __init__(
        self, sensor: TipSensor, times: EndpointTicks, plant: Plant, true: RobotModel, nominal: RobotModel
    ) -> None:
        self._sensor, self._times, self._plant, self._true, self._nominal = sensor, times, plant, true, nominal
        self._differences: list[FloatArray] = []

    def correct(self, tick: int, q: FloatArray, dq: FloatArray, desired: FloatArray) -> FloatArray:
        """Return the desired motion for the tip as computed from the encoders.

        Args:
            tick: Number of the loop's tick, from 0.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            desired: Desired motion of the tip, shape (3, 3): position, velocity, acceleration.
        """
        if tick % self._times.every == 0:
            plant = self._plant
            true = plant.tip_motion() if plant.bends else _moves(self._true, plant.q, plant.dq)
            measured = self._sensor.measure(tick // self._times.every, true)
            self._differences.append(measured - _moves(self._nominal, q, dq))
        known = (tick - self._times.late) // self._times.every
        corrected = desired.copy()
        if known >= 0:
            corrected[:2] -= self._differences[known]
        return corrected


def make_measured_tips(closed: ClosedLoop, config: RunConfig, repetition: int) -> Mapping[str, MeasuredTip]:
    """Build the tip measurements of one repetition, by the loops that read the sensor.

    The noise depends only on (seed, repetition) and the loop's index, and does not change other draws.
    """
    ticks, made = endpoint_ticks(config), {}
    for place, loop in enumerate(closed.loops):
        if loop.name in ticks:
            times = ticks[loop.name]
            sensor = ENDPOINT_SENSORS.build(
                config.endpoint_sensor,
                -(-(closed.ticks // closed.every(loop) + 1) // times.every),
                loop.period * times.every,
                np.random.default_rng([config.settings.seed, repetition, TIP, place]),
            )
            made[loop.name] = MeasuredTip(sensor, times, closed.plant, closed.robot.model, closed.nominal.model)
    return made


def _moves(arm: RobotModel, q: FloatArray, dq: FloatArray) -> FloatArray:
    """Return position and velocity of an arm's tip, shape (2, 3), in m and m/s."""
    return np.array([arm.tip_position(q), arm.tip_jacobian(q)[:3] @ dq])


@dataclass
class _Reader:
    """A controller that reads the torque sensors at its ticks: the mean since its last tick."""

    controller: ControlLaw
    every: int
    sum: FloatArray
    count: int = 0


class JointTorques:
    """The joint torque sensors during a run.

    Args:
        closed: The closed loop.
        sensor: The sensors, with a draw for each tick; None without sensors.
        timing: Command that acts in each tick.
        commands: Commands in each tick, shape (T, nq), in N m.
    """

    def __init__(
        self, closed: ClosedLoop, sensor: TorqueSensors | None, timing: CommandTiming, commands: FloatArray
    ) -> None:
        self._plant, self._sensor, self._timing, self._commands = closed.plant, sensor, timing, commands
        self._readers = [
            _Reader(loop.controller, closed.every(loop), np.zeros(commands.shape[1]))
            for loop in closed.loops
            if sensor is not None and loop.controller.reads_joint_torques
        ]

    def update(self, k: int) -> None:
        """Add the torques that acted before tick k; pass the mean since the last tick to controllers with a tick."""
        if k == 0 or not self._readers:
            return
        acted = self._timing.at(self._commands, k - 1) - self._plant.friction
        for reader in self._readers:
            reader.sum, reader.count = reader.sum + acted, reader.count + 1
            if k % reader.every == 0 and self._sensor is not None:
                reader.controller.read_joint_torques(self._sensor.read(k, reader.sum / reader.count))
                reader.sum, reader.count = np.zeros_like(reader.sum), 0


def make_joint_torque_sensor(closed: ClosedLoop, config: RunConfig, repetition: int) -> TorqueSensors | None:
    """Build the torque sensors of the joints for one repetition; None without sensors.

    The noise depends only on (seed, repetition), and does not change other draws.
    """
    if config.joint_torque_sensor is None:
        return None
    generator = np.random.default_rng([config.settings.seed, repetition, JOINT_TORQUES])
    joints = closed.robot.model.joint_names
    return JOINT_TORQUE_SENSORS.build(config.joint_torque_sensor, joints, closed.ticks + 1, generator)


def make_sensors(
    closed: ClosedLoop, config: RunConfig, repetition: int
) -> tuple[
    Sequence[Encoders], WristSensor | None, TorqueSensors | None, Mapping[str, MeasuredTip], CommandTiming | None
]:
    """Build what differs between repetitions: encoders; sensors at wrist, joints and tip; and command timing."""
    seed = config.settings.seed
    return (
        make_encoders(closed, config.noise, seed, repetition),
        make_wrist_sensor(closed, config.wrist_sensor, seed, repetition),
        make_joint_torque_sensor(closed, config, repetition),
        make_measured_tips(closed, config, repetition),
        make_command_timing(closed, config, repetition),
    )


def make_command_timing(closed: ClosedLoop, config: RunConfig, repetition: int) -> CommandTiming | None:
    """Draw the acting command of each tick of one repetition; None for the closed loop's constant delay.

    The draws depend only on (seed, repetition) and the loop's index, and do not change other draws.
    """
    if closed.delay is not None:
        return None
    computation, seed = options_of(config.plant).computation, config.settings.seed
    rows = [
        computation.arrivals(
            late, closed.every(loop), closed.ticks + 1, np.random.default_rng([seed, repetition, COMPUTATION, place])
        )
        for place, (loop, late) in enumerate(zip(closed.loops, config.timing.late, strict=True))
    ]
    return CommandTiming([loop.joints for loop in closed.loops], rows)


def make_encoders(closed: ClosedLoop, noise: KindConfig, seed: int, repetition: int) -> list[Encoders]:
    """Build the joint measurement of each loop for one repetition.

    The noise depends only on (seed, repetition) and the loop's index. It starts with the same values whatever the
    length of the run and the periods of other loops, so runs can be compared in pairs.
    """
    return [
        NOISES.build(
            noise,
            closed.robot.model.joint_names,
            closed.ticks // closed.every(loop) + 1,
            loop.period,
            np.random.default_rng([seed, repetition, place]),
        )
        for place, loop in enumerate(closed.loops)
    ]


def make_wrist_sensor(closed: ClosedLoop, sensor: KindConfig, seed: int, repetition: int) -> WristSensor | None:
    """Build the force/torque sensor of one repetition, with noise as for encoders; None without contact."""
    if closed.interaction is None:
        return None
    generator = np.random.default_rng([seed, repetition, len(closed.loops)])
    return WRIST_SENSORS.build(sensor, closed.ticks + 1, closed.tick, generator)
