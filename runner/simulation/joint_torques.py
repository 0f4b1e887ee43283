"""Joint torque sensors and their readings for the controllers."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.config.run import RunConfig
from runner.controllers.kinds import ReadsJointTorques
from runner.plants.friction import friction_of
from runner.sensing import JOINT_TORQUE_SENSORS, JointTorqueSensor, TorqueSensors
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.recorder import Recorder

_SEED = 2**32 - 2  # in the seeds of these sensors; the loops' places count from 0, and nominal models have 2**32 - 1


@dataclass
class _Reader:
    """A controller that reads the sensors at its ticks: the mean of what acted since the last one."""

    controller: ReadsJointTorques
    every: int
    sum: FloatArray
    count: int = 0


class JointTorques:
    """The sensors at work.

    Args:
        closed: The closed loop.
        sensor: The sensors, with a draw for each tick; None where there are none.
        recorder: Holds what the loops asked for, and tells which of it acts.
    """

    def __init__(self, closed: ClosedLoop, sensor: TorqueSensors | None, recorder: Recorder) -> None:
        self._closed, self._sensor, self._recorder = closed, sensor, recorder
        self._readers = [
            _Reader(loop.controller, closed.every(loop), np.zeros(recorder.commands.shape[1]))
            for loop in closed.loops
            if sensor is not None and isinstance(loop.controller, ReadsJointTorques)
        ]

    def tell(self, k: int) -> None:
        """Tell those that tick in tick k what acted since their last tick; nothing before the first."""
        for reader in self._readers:
            if k % reader.every == 0 and reader.count and self._sensor is not None:
                reader.controller.read_joint_torques(self._sensor.read(k, reader.sum / reader.count))
                reader.sum, reader.count = np.zeros_like(reader.sum), 0

    def keep(self, k: int) -> None:
        """Keep what acted from tick k to the next one."""
        if not self._readers:
            return
        acted = self._recorder.timing.at(self._recorder.commands, k) - friction_of(self._closed.plant)
        for reader in self._readers:
            reader.sum, reader.count = reader.sum + acted, reader.count + 1


def make_joint_torque_sensor(closed: ClosedLoop, config: RunConfig, repetition: int) -> TorqueSensors | None:
    """Make the torque sensors of the joints for one repetition, where there are any.

    Their noise follows from (seed, repetition) alone, and changes no other draw.
    """
    plugged = config.plugged.get("joint_torque_sensor")
    if config.joint_torques is None and plugged is None:
        return None
    generator = np.random.default_rng([config.settings.seed, repetition, _SEED])
    if plugged is not None:
        return JOINT_TORQUE_SENSORS.build(plugged, closed.robot.model.joint_names, closed.ticks + 1, generator)
    assert config.joint_torques is not None  # noqa: S101 - one of both is there
    return JointTorqueSensor(closed.ticks + 1, *config.joint_torques, generator)
