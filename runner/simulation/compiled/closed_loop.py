"""Compiled closed loops: commands of each tick, or whole runs, one or many at a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.compiled_motion import MotionScalars, expressed_motion, motion_pattern, motion_scalars
from runner.plants.decoupled import Motion
from runner.simulation.compiled.commands import Commands, CommandScalars, expressed_commands
from runner.symbolic.arm import NoConstantFolding
from runner.symbolic.code import ACTING, Slots
from runner.symbolic.expression import places
from runner.symbolic.program import LANES, Expressed, Frame, Program, program
from runner.symbolic.structure import Values

_AT_ONCE = 10_000  # ticks between two checks for interrupts


class CompiledCommands:
    """The compiled commands of one arm's loops, tick by tick, for a plant that is not compiled.

    Args:
        commands: The loops.

    Raises:
        CannotCompileError: if a control law has no compiled form.
    """

    def __init__(self, commands: Commands) -> None:
        def express() -> Expressed:
            at = Slots()
            _, kept, errors = expressed_commands(commands, commands.scalars(at.number), at)
            return Expressed([kept], [], at.widths, errors)

        what = f"the control law of {len(commands.limits)} joints"
        self._commands = commands
        self._program = program(f"commands {commands.pattern}", what, express, 1, commands.are_ours)
        values = Values()
        commands.scalars(values.number)
        self._values = values.values

    def begin(
        self,
        times: FloatArray,
        desired: FloatArray,
        errors: Sequence[FloatArray],
        q: FloatArray,
        joints: FloatArray | None = None,
    ) -> "CommandsRun":
        """Start a run at rest.

        Args:
            times: Time of each tick, shape (T,), in s.
            desired: Desired motion of the tip, shape (T, 3, 3).
            errors: Errors of the positions at the ticks of each loop, shape (n, nq), in rad.
            q: Initial joint positions, shape (nq,), in rad.
            joints: Desired motion of the joints, shape (T, 3, nq); None if no loop follows it.
        """
        commands, frame = self._commands, self._program.frame(len(times))
        wrong = commands.measured_wrong(errors, len(times))
        frame.given[:, :, 0] = np.hstack([commands.shared(times, desired, joints), wrong])
        frame.state[:, 0] = commands.start(q[None], [each[:1] for each in errors])[0]
        frame.pars[:, 0] = self._values
        return CommandsRun(frame, self._commands, times, self._program.errors)


class CommandsRun:
    """One run, tick by tick.

    Args:
        frame: Arrays of the run.
        commands: The loops.
        times: Time of each tick, shape (T,), in s.
        errors: Messages of the possible failures.

    Attributes:
        q: Joint positions at each tick, shape (T, nq), in rad.
        dq: Joint velocities, shape (T, nq), in rad/s.
        torque: Torques within their limits, shape (T, nq), in N m.
        end_points: End point of each stage, shape (stages, T, 3), in m.
    """

    def __init__(self, frame: Frame, commands: Commands, times: FloatArray, errors: Sequence[str]) -> None:
        self._commands, self._times = commands, times
        rows, nq = frame.rows[:, :, 0], len(commands.limits)
        self.q, self.dq, self.torque = (rows[:, part * nq : (part + 1) * nq] for part in range(3))
        self._fault, self.end_points = rows[:, 3 * nq], rows[:, 3 * nq + 1 :].reshape(len(times), -1, 3).swapaxes(0, 1)
        self._true_q, self._true_dq = frame.state[:nq, 0], frame.state[nq : 2 * nq, 0]
        self._span, self._call, self._errors, self._guarded = frame.span, frame.call, errors, commands.guarded

    def tick(self, k: int, q: FloatArray, dq: FloatArray) -> None:
        """Compute tick k, after the previous one, from the true state, shapes (nq,).

        Raises:
            LinAlgError: if a control law has no solution.
            SimulationError: if a user-supplied law returns values that are not finite.
        """
        self._true_q[:] = q
        self._true_dq[:] = dq
        self._span[0], self._span[1] = k, k + 1
        self._call()
        if self._fault[k]:
            raise np.linalg.LinAlgError(self._errors[int(self._fault[k]) - 1])
        if self._guarded:
            fault = self._commands.fault(self.torque[k], self._times[k])
            if fault is not None:
                raise fault


@dataclass(frozen=True)
class LoopProgram:
    """A closed loop that is compiled as a whole.

    Attributes:
        commands: The control loops.
        motion: The motion of the arms.
        tick: Time between two ticks, in s.
        step: Integration step, in s.
        steps: Steps in a tick.
        delay: Ticks from a command until it acts.
    """

    commands: Commands
    motion: Motion
    tick: float
    step: float
    steps: int
    delay: int

    @cached_property
    def pattern(self) -> str:
        """A string that is the same for two programs with the same code."""
        return f"run {self.commands.pattern} {motion_pattern(self.motion)}"

    def program(self, lanes: int) -> Program:
        """Return the compiled code.

        Raises:
            CannotCompileError: if a control law has no compiled form.
        """

        def express() -> Expressed:
            at = Slots()
            return self.express(at, at.number)

        return program(
            self.pattern,
            f"a control tick of {len(self.commands.limits)} joints",
            express,
            lanes,
            self.commands.are_ours,
        )

    def express(self, at: Slots, number: Callable[[float], Any]) -> Expressed:
        """Return the expressions in new slots, with numbers converted by `number`.

        Raises:
            CannotCompileError: if a control law has no compiled form.
        """
        commands, numbers = self._scalars(number)
        torques, kept, errors = expressed_commands(self.commands, commands, at)
        nq = len(torques)
        moved = expressed_motion(self.motion, numbers, at, places(ACTING, 2 * nq, nq))
        return Expressed([kept], moved, at.widths, errors)

    @cached_property
    def values(self) -> FloatArray:
        """Values of the code's parameters."""
        values = Values()
        self._scalars(values.number)
        return np.array(values.values)

    @cached_property
    def numbers(self) -> FloatArray:
        """All numbers, in the order of the parameters, including those equal to 0, 1 or -1."""
        values = Values()
        self._scalars(NoConstantFolding(values.number))
        return np.array(values.values)

    def _scalars(self, number: Callable[[float], Any]) -> tuple[CommandScalars, MotionScalars]:
        return self.commands.scalars(number), motion_scalars(self.motion, self.step, self.tick, number)


@dataclass(frozen=True)
class Signals:
    """True signals of runs, a row for each tick.

    Attributes:
        q: Joint positions, shape (runs, T, nq), in rad.
        dq: Joint velocities, shape (runs, T, nq), in rad/s.
        torque: Commanded torques within their limits, shape (runs, T, nq), in N m.
        fault: Number of the failure in a control law, 0 for none, shape (runs, T).
        end_points: End point of each stage, shape (stages, runs, T, 3), in m.
        errors: Messages of the possible failures; failure 1 is the first.
        commands: The control loops of one of the runs.
    """

    q: FloatArray
    dq: FloatArray
    torque: FloatArray
    fault: FloatArray
    end_points: FloatArray
    errors: Sequence[str]
    commands: Commands

    def first_fault(self, run: int, times: FloatArray) -> tuple[int, Exception] | None:
        """Return the first tick in which a run's law failed, and the error; None without a failure."""
        failed = np.flatnonzero(self.fault[run, : len(times)])
        watched = self.torque[run, : len(times) if self.commands.guarded else 0]
        wild = np.flatnonzero(~np.isfinite(watched).all(axis=1))
        first = min([*failed[:1], *wild[:1]], default=None)
        if first is None:
            return None
        if len(failed) and first == failed[0]:
            return int(first), np.linalg.LinAlgError(self.errors[int(self.fault[run, first]) - 1])
        error = self.commands.fault(self.torque[run, first], float(times[first]))
        assert error is not None  # noqa: S101 - a torque is not finite there
        return int(first), error


def run_all(
    loop_program: LoopProgram, values: FloatArray, shared: FloatArray, errors: Sequence[FloatArray], start: FloatArray
) -> Signals:
    """Compute runs with the same code and number of ticks; results are bit-identical to separate runs.

    Args:
        loop_program: The closed loop of one of the runs.
        values: Parameters of each run, shape (runs, parameters); see LoopProgram.values.
        shared: Time and path at each tick, shape (T, entries) if they are the same for all runs, else (runs, T,
            entries).
        errors: Errors of the positions at the ticks of each loop, shape (runs, n, nq), in rad.
        start: Initial state of each run, shape (runs, entries); see Commands.start.

    Raises:
        CannotCompileError: if a control law has no compiled form.
    """
    count, ticks, nq, stages = (
        len(start),
        shared.shape[-2],
        len(loop_program.commands.limits),
        len(loop_program.motion.robot.stages),
    )
    code = loop_program.program(1 if count == 1 else LANES)
    frame = code.frame(ticks, loop_program.delay, loop_program.steps)
    q, dq, torque = (np.empty((count, ticks, nq)) for _ in range(3))
    points = np.empty((stages, count, ticks, 3))
    found = Signals(q, dq, torque, np.empty((count, ticks)), points, code.errors, loop_program.commands)
    wide, long = shared.shape[-1], start.shape[1]
    for first in range(0, count, code.lanes):
        own = slice(first, min(first + code.lanes, count))
        used = own.stop - first  # idle lanes continue with the values of earlier runs
        if shared.ndim == 3 or first == 0:
            frame.given[:, :wide, : used if shared.ndim == 3 else code.lanes] = _lanes(shared, own)
        wrong = loop_program.commands.measured_wrong([each[own] for each in errors], ticks)
        frame.given[:, wide:, :used] = wrong.transpose(1, 2, 0)
        frame.state[:long, :used], frame.state[long:] = start[own].T, 0.0
        frame.pars[:, :used] = values[own].T
        for begin in range(0, ticks, _AT_ONCE):
            frame.span[:] = begin, min(begin + _AT_ONCE, ticks)
            frame.call()
        rows = frame.rows[:, :, :used].transpose(2, 0, 1)
        found.q[own], found.dq[own], found.torque[own] = (rows[:, :, k * nq : (k + 1) * nq] for k in range(3))
        found.fault[own] = rows[:, :, 3 * nq]
        found.end_points[:, own] = rows[:, :, 3 * nq + 1 :].reshape(used, ticks, stages, 3).transpose(2, 0, 1, 3)
    return found


def _lanes(shared: FloatArray, runs: slice) -> FloatArray:
    """Return time and path with runs on the last axis, shape (T, entries, runs); 1 if they are the same for all."""
    found: FloatArray = shared[:, :, None] if shared.ndim == 2 else shared[runs].transpose(1, 2, 0)
    return found
