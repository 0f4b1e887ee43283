"""Correction of the desired motion by a position sensor of the tip."""

from collections.abc import Mapping

import numpy as np

from runner.base.arrays import FloatArray
from runner.config.endpoint_sensor import endpoint_ticks
from runner.config.run import RunConfig
from runner.plants import Plant, PositionPlant, TellsEndPoints, unwrapped
from runner.robots.model import RobotModel
from runner.sensing.endpoint import EndpointSensor
from runner.simulation.closed_loop import ClosedLoop

_SEED = 2**32 - 3  # in the seeds of these sensors; the loops' places count from 0, others are 2**32 - 2 and - 1


class MeasuredTip:
    """What a control loop asks of its law, to lead the measured tip and not the one that the encoders tell.

    Args:
        sensor: The sensor, with a draw for each measurement.
        plant: The plant, for the true tip.
        true: The robot as it is.
        nominal: The nominal robot.
    """

    def __init__(
        self, sensor: EndpointSensor, plant: Plant | PositionPlant, true: RobotModel, nominal: RobotModel
    ) -> None:
        self._sensor, self._plant, self._true, self._nominal = sensor, plant, true, nominal
        moved = unwrapped(plant)
        self._bent = moved if isinstance(moved, TellsEndPoints) else None

    def correct(self, tick: int, q: FloatArray, dq: FloatArray, desired: FloatArray) -> FloatArray:
        """Return the motion that the law is to ask of the tip as the encoders tell it.

        Args:
            tick: Number of the loop's tick, from 0.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, likewise, in rad/s.
            desired: Desired motion of the tip, shape (3, 3): position, velocity, acceleration.
        """
        if self._sensor.due(tick):
            straight, bent = self._plant, self._bent
            true = _moves(self._true, straight.q, straight.dq) if bent is None else bent.tip_motion()
            self._sensor.measure(tick, true, _moves(self._nominal, q, dq))
        corrected = desired.copy()
        corrected[:2] -= self._sensor.correction(tick)
        return corrected


def make_measured_tips(closed: ClosedLoop, config: RunConfig, repetition: int) -> Mapping[str, MeasuredTip]:
    """Make what loops know of the tip for one repetition, by the loops that read the sensor.

    Its noise follows from (seed, repetition) and the loop's place alone, and changes no other draw.
    """
    ticks = endpoint_ticks(config)
    return {
        loop.name: MeasuredTip(
            EndpointSensor(
                closed.ticks // closed.every(loop) + 1,
                loop.period,
                config.endpoint_sensor,
                ticks[loop.name],
                np.random.default_rng([config.settings.seed, repetition, _SEED, place]),
            ),
            closed.plant,
            closed.robot.model,
            closed.nominal.model,
        )
        for place, loop in enumerate(closed.loops)
        if loop.name in ticks
    }


def _moves(arm: RobotModel, q: FloatArray, dq: FloatArray) -> FloatArray:
    """Return position and velocity of an arm's tip, shape (2, 3), in m and m/s."""
    return np.array([arm.tip_position(q), arm.tip_jacobian(q)[:3] @ dq])
