"""Command of one control loop, updated at its own ticks."""

from collections.abc import Callable
from typing import cast

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers import Controller, Loop, PositionController
from runner.sensing import Encoders
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.endpoint import MeasuredTip
from runner.simulation.recorder import Recorder

Law = Callable[[float, FloatArray, FloatArray, FloatArray], FloatArray]


class Command:
    """A control loop at work: it reads the encoders, asks its law, and holds the answer, clipped, until its next tick.

    Args:
        closed: The closed loop.
        loop: The control loop; its controller is reset here.
        encoders: Its joint measurement, with a draw for each of its ticks.
        recorder: Holds reference and time, and takes what is asked for.
        tip: What the loop knows of the tip beside the encoders; None where that is nothing.

    Attributes:
        every: Ticks between two of its own.
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
        self._held: FloatArray = recorder.command[loop.joints]  # a view: what is written there is what is asked for
        self._highest: FloatArray = closed.limits[loop.joints]
        self._lowest: FloatArray = -self._highest
        self._clipped = closed.commands == "torque" and bool(np.isfinite(self._highest).any())

    def update(self, k: int, q: FloatArray, dq: FloatArray) -> None:
        """Ask the law in tick k, from the true state, shapes (nq,)."""
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
    """Reset a loop's controller, and return its law."""
    if closed.commands == "torque":
        controller = cast(Controller, loop.controller)
        controller.reset()
        return controller.torque
    follower = cast(PositionController, loop.controller)
    follower.reset(closed.q_start)
    return follower.joint_positions
