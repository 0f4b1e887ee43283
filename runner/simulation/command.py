"""Command of one control loop, updated at its own ticks, and the input of the plant for one tick."""

from collections.abc import Callable
from typing import Protocol, cast

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers import Controller, Loop, PositionController
from runner.plants import Plant, PositionPlant
from runner.sensing import Encoders
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.recorder import Recorder
from runner.simulation.sensors import MeasuredTip

Law = Callable[[float, FloatArray, FloatArray, FloatArray], FloatArray]


class Command:
    """The command of a control loop: computed from the encoders at its ticks, clipped, and held until its next tick.

    Args:
        closed: The closed loop.
        loop: The control loop; its controller is reset here.
        encoders: Joint measurement of the loop, with a draw for each of its ticks.
        recorder: Recorder with reference and time, which stores the command.
        tip: Tip measurement of the loop besides the encoders; None without one.

    Attributes:
        every: Ticks between two ticks of the loop.
    """

    def __init__(
        self, closed: ClosedLoop, loop: Loop, encoders: Encoders, recorder: Recorder, tip: MeasuredTip | None = None
    ) -> None:
        self.every = closed.every(loop)
        self._law = _reset(closed, loop)
        self._measure, self._tip = encoders.measure, tip
        self._times = recorder.times
        self._desired = recorder.joints if loop.follows_joints and recorder.joints is not None else recorder.desired
        self._motors, self._joints = closed.motor_side, loop.joints
        self._held: FloatArray = recorder.command[loop.joints]  # a view: values written here are the command
        self._highest: FloatArray = closed.limits[loop.joints]
        self._lowest: FloatArray = -self._highest
        self._clipped = closed.commands == "torque" and bool(np.isfinite(self._highest).any())

    def update(self, k: int, q: FloatArray, dq: FloatArray) -> None:
        """Compute the command of tick k from the true state, shapes (nq,)."""
        tick, desired = k // self.every, self._desired[k]
        q, dq = self._measure(tick, q, dq)
        if self._tip is not None:
            desired = self._tip.correct(tick, q, dq, desired)
        asked = self._law(self._times[k], q, dq, desired)
        if self._motors is not None:
            asked = asked + self._motors.damping()[self._joints]
        if self._clipped:
            np.minimum(asked, self._highest, out=asked)
            np.maximum(asked, self._lowest, out=asked)
        self._held[:] = asked


def _reset(closed: ClosedLoop, loop: Loop) -> Law:
    """Reset a loop's controller; return its control law."""
    if closed.commands == "torque":
        controller = cast(Controller, loop.controller)
        controller.reset()
        return controller.torque
    follower = cast(PositionController, loop.controller)
    follower.reset(closed.q_start)
    return follower.joint_positions


class PlantInput(Protocol):
    """Input of the plant from the loops' commands."""

    def advance(self, k: int, load: FloatArray | None) -> None:
        """Advance the plant from tick k to the next one under external joint torques, shape (nq,), in N m."""


class TorqueInput:
    """Input of a plant from the loops' torques and external torques.

    Args:
        plant: The plant.
        recorder: Recorder with the commands and their timing.
    """

    def __init__(self, plant: Plant, recorder: Recorder) -> None:
        self._plant, self._timing, self._commands = plant, recorder.timing, recorder.commands

    def advance(self, k: int, load: FloatArray | None) -> None:
        """Advance the plant; see PlantInput."""
        command = self._timing.at(self._commands, k)
        self._plant.advance(command) if load is None else self._plant.push(command, load)


class PositionInput:
    """Input of a plant that follows joint positions; its torques are recorded.

    Args:
        plant: The plant.
        recorder: Recorder with the commands and their timing, which stores the torques.
    """

    def __init__(self, plant: PositionPlant, recorder: Recorder) -> None:
        self._plant, self._timing, self._commands = plant, recorder.timing, recorder.commands
        self._torques = recorder.torques

    def advance(self, k: int, load: FloatArray | None) -> None:
        """Advance the plant; see PlantInput."""
        if load is not None:
            self._plant.load[:] = load
        self._plant.advance(self._timing.at(self._commands, k))
        self._torques[k] = self._torques[k + 1] = self._plant.tau


def make_plant_input(closed: ClosedLoop, recorder: Recorder) -> PlantInput:
    """Return the input of a closed loop's plant, for torque or position commands."""
    if closed.commands == "position":
        return PositionInput(cast(PositionPlant, closed.plant), recorder)
    return TorqueInput(closed.plant, recorder)
