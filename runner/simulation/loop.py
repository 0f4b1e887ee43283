"""Closed-loop simulation of one run, tick by tick: plant, encoders, controllers and desired motion."""

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, cast

import numpy as np

from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.compiled.loops import CompiledLoops, Rows
from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.base.ticks import track_ticks
from runner.base.trace import Trace
from runner.controllers import Controller, Loop, PositionController
from runner.plants import PositionPlant
from runner.sensing import Encoders, TorqueSensors, WristSensor
from runner.sensing.encoders import JointEncoders
from runner.simulation.contact import Contact
from runner.simulation.recorder import CHECK_EVERY, CommandTiming, Recorder, constant_delay
from runner.simulation.sensors import JointTorques, MeasuredTip


def simulate(
    closed: ClosedLoop,
    encoders: Sequence[Encoders],
    wrist: WristSensor | None = None,
    torques: TorqueSensors | None = None,
    tips: Mapping[str, MeasuredTip] | None = None,
    timing: CommandTiming | None = None,
) -> Trace:
    """Run the control loops once.

    At each of its ticks, a loop reads the encoders of every joint and calls its controller. The torques are clipped
    joint by joint and held until the loop's next tick. They act after the delay, and the trace contains the acting
    torques; the first command acts from the start. The last row contains the final state and the torques that would act
    next. Position commands are not clipped. The trace then contains the plant's torques, and the last row repeats those
    of the last tick.

    Args:
        closed: The control loops; plant and controllers are reset here.
        encoders: Joint measurement of each loop, with a draw for each of its ticks; built-in for compiled loops.
        wrist: Force/torque sensor, with a draw for each tick; required for contact.
        torques: Torque sensors in the joints, with a draw for each tick; required if a control law reads them.
        timing: Command that acts in each tick; None for the constant delay of the closed loop.
        tips: Tip measurements besides the encoders, by loop; required if a loop reads a tip sensor.

    Returns:
        The trace; it contains a failure if the run ends early.
    """
    ticks = closed.ticks + 1
    timing = timing or constant_delay(closed.robot.model.nq, closed.delay or 0, ticks)
    laws: ControlLoops
    if closed.compiled is not None:
        errors = [cast(JointEncoders, each).errors for each in encoders]
        laws = CompiledLoops(closed.compiled, ticks, errors, closed.drawn)
    else:
        laws = InterpretedLoops(closed, encoders, tips or {}, torques, timing)
    recorder = Recorder(closed, timing, laws.rows)
    try:
        recorder.desired[:] = closed.trajectory.sample(recorder.times)
        joints = closed.trajectory.sample_joints(recorder.times)
        contact = None
        if closed.interaction is not None and wrist is not None:
            contact = Contact(closed, wrist)
            recorder.contact = contact.signals
        # A diverging run ends as a failure, not as a warning.
        with track_ticks(recorder.clock, closed.ticks), np.errstate(over="ignore", invalid="ignore"):
            laws.start(recorder.times, recorder.desired, joints, closed.q_start)
            closed.plant.reset(closed.q_start, np.zeros_like(closed.q_start))
            _run(closed, laws, contact, recorder)
    except (np.linalg.LinAlgError, SimulationError) as error:
        recorder.stop(0, error)
    return recorder.trace()


class ControlLoops(Protocol):
    """The control loops of a closed loop, interpreted or compiled.

    Attributes:
        rows: Signals of the run; `update` stores the commands.
    """

    rows: Rows

    def start(self, times: FloatArray, desired: FloatArray, joints: FloatArray | None, q: FloatArray) -> None:
        """Start a run at rest.

        Args:
            times: Time of each tick, shape (T,), in s.
            desired: Desired motion of the tip, shape (T, 3, 3).
            joints: Desired motion of the joints, shape (T, 3, nq); None if only the tip's motion is given.
            q: Joint positions, shape (nq,), in rad.
        """

    def update(self, k: int, q: FloatArray, dq: FloatArray) -> None:
        """Compute and store the commands of tick k from the true state, shapes (nq,)."""


def _run(closed: ClosedLoop, laws: ControlLoops, contact: Contact | None, recorder: Recorder) -> None:
    plant, update, now, acting, torques = closed.plant, laws.update, recorder.now, recorder.timing.at, recorder.torques
    kept_q, kept_dq, commands, _, end_points, _ = recorder.rows
    times, clock, asked, bends, load, k = recorder.times, recorder.clock, recorder.asked, plant.bends, None, 0
    try:
        for k in range(closed.ticks + 1):
            clock[k] = now()
            kept_q[k] = q = plant.q
            kept_dq[k] = dq = plant.dq
            if closed.motor_side is not None:
                recorder.speeds[k] = closed.motor_side.plant.dtheta
            if bends:
                end_points[:, k] = plant.end_points()
            if contact is not None:
                load = contact.update(k, times[k], q, dq)
            begun = now()
            update(k, q, dq)
            asked[k] = now() - begun
            if k % CHECK_EVERY == 0:
                recorder.check_divergence(k)
            if k < closed.ticks:
                command = acting(commands, k)
                plant.advance(command) if load is None else plant.push(command, load)
                if torques is not None:
                    torques[k] = torques[k + 1] = cast(PositionPlant, plant).tau
        recorder.check_divergence(closed.ticks)
    except (np.linalg.LinAlgError, SimulationError) as error:
        recorder.stop(k, error)


Law = Callable[[float, FloatArray, FloatArray, FloatArray], FloatArray]


class InterpretedLoops:
    """Control loops whose controllers are called one by one; see ControlLoops.

    Args:
        closed: The closed loop; its controllers are reset at the start.
        encoders: Joint measurement of each loop, with a draw for each of its ticks.
        tips: Tip measurements besides the encoders, by loop.
        sensor: Torque sensors in the joints; None without sensors.
        timing: Command that acts in each tick.

    Attributes:
        rows: Signals of the run.
    """

    def __init__(
        self,
        closed: ClosedLoop,
        encoders: Sequence[Encoders],
        tips: Mapping[str, MeasuredTip],
        sensor: TorqueSensors | None,
        timing: CommandTiming,
    ) -> None:
        self._closed, self._encoders, self._tips = closed, encoders, tips
        self.rows = Rows.new(np.zeros, (closed.ticks + 1,), closed.robot.model.nq, len(closed.robot.stages))
        self._torques = JointTorques(closed, sensor, timing, self.rows.command)

    def start(self, times: FloatArray, desired: FloatArray, joints: FloatArray | None, q: FloatArray) -> None:
        """Reset the controllers; see ControlLoops."""
        closed = self._closed
        self._current = q.copy() if closed.commands == "position" else np.zeros_like(q)
        self._commands = [
            _Command(closed, loop, encoders, self._tips.get(loop.name), times, self._current,
                     joints if loop.follows_joints and joints is not None else desired)
            for loop, encoders in zip(closed.loops, self._encoders, strict=True)
        ]  # fmt: skip

    def update(self, k: int, q: FloatArray, dq: FloatArray) -> None:
        """Call the controllers that have a tick; see ControlLoops."""
        self._torques.update(k)
        if self._closed.motor_side is not None:
            q, dq = self._closed.motor_side.read()
        for command in self._commands:
            if k % command.every == 0:
                command.update(k, q, dq)
        self.rows.command[k] = self._current


class _Command:
    """The command of a control loop: computed from the encoders at its ticks, clipped, and held until its next tick.

    It is written to the loop's joints of `commands`, shape (nq,). The loop has a tick in each `every`-th tick of a run.
    """

    def __init__(
        self,
        closed: ClosedLoop,
        loop: Loop,
        encoders: Encoders,
        tip: MeasuredTip | None,
        times: FloatArray,
        commands: FloatArray,
        desired: FloatArray,
    ) -> None:
        self.every = closed.every(loop)
        self._law = _reset(closed, loop)
        self._measure, self._tip, self._times, self._desired = encoders.measure, tip, times, desired
        self._motors, self._joints = closed.motor_side, loop.joints
        self._held: FloatArray = commands[loop.joints]  # a view: values written here are the command
        self._limits = closed.limits.of(loop.joints)
        self._lowest, self._highest = -self._limits.max, self._limits.max
        self._clipped = closed.commands == "torque" and bool(np.isfinite(self._highest).any())

    def update(self, k: int, q: FloatArray, dq: FloatArray) -> None:
        """Compute the command of tick k from the true state, shapes (nq,)."""
        tick, desired, true_dq = k // self.every, self._desired[k], dq
        q, dq = self._measure(tick, q, dq)
        if self._tip is not None:
            desired = self._tip.correct(tick, q, dq, desired)
        asked = self._law(self._times[k], q, dq, desired)
        if self._motors is not None:
            asked, true_dq = asked + self._motors.damping()[self._joints], self._motors.plant.dtheta
        if self._clipped:
            if self._limits.depend_on_speed:
                self._lowest, self._highest = self._limits.bounds(true_dq[self._joints])
            np.minimum(asked, self._highest, out=self._held)
            np.maximum(self._held, self._lowest, out=self._held)
        else:
            self._held[:] = asked


def _reset(closed: ClosedLoop, loop: Loop) -> Law:
    if closed.commands == "torque":
        controller = cast(Controller, loop.controller)
        controller.reset()
        return controller.torque
    follower = cast(PositionController, loop.controller)
    follower.reset(closed.q_start)
    return follower.joint_positions
