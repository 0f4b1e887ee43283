"""Closed loops compiled as a whole: many runs at a time, and their derivatives by several parameters at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.assembly.compiled.commands import Commands, CommandScalars, expressed_commands
from runner.assembly.compiled.loops import Rows
from runner.base.arrays import FloatArray
from runner.plants.decoupled import Motion
from runner.plants.whole_motion import MotionScalars, expressed_motion, motion_pattern, motion_scalars
from runner.symbolic.arm import Folding
from runner.symbolic.code import ACTING, GIVEN, PARS, ROWS, STATE, Slots
from runner.symbolic.expression import places
from runner.symbolic.program import LANES, Expressed, Frame, Program, program
from runner.symbolic.structure import constants_in, values_of
from runner.symbolic.tangent import with_tangents

_FOLDED = (0.0, 1.0, -1.0)
_AT_ONCE = 10_000  # ticks between two checks for interrupts


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
            f"a control tick of {len(self.commands.limits.max)} joints",
            express,
            lanes,
            self.commands.are_ours,
        )

    def code_for(self, runs: int) -> Program:
        """Return the compiled code for a number of runs; see `program`."""
        return self.program(1 if runs == 1 else LANES)

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
        """Values of the code's parameters, shape (k,)."""
        return values_of(self._scalars)

    @cached_property
    def numbers(self) -> FloatArray:
        """All numbers, in the order of the parameters, including those equal to 0, 1 or -1."""
        return values_of(lambda number: self._scalars(Folding(number, number)))

    @cached_property
    def constants(self) -> list[float | None]:
        """Constants of the code; see constants_in."""
        return constants_in(self._scalars)

    def drawn_values(self, drawn: Commands) -> FloatArray:
        """Return the parameters of this code for loops with drawn nominal models, shape (runs, k)."""
        return drawn.by_run(values_of(replace(self, commands=drawn)._scalars, self.constants))

    def _scalars(self, number: Callable[[float], Any]) -> tuple[CommandScalars, MotionScalars]:
        return self.commands.scalars(number), motion_scalars(self.motion, self.step, self.tick, number)

    def first_fault(self, rows: Rows, run: int, times: FloatArray) -> tuple[int, Exception] | None:
        """Return the first tick in which the law of one of several runs failed, and the error; None without one."""
        failed = np.flatnonzero(rows.fault[run, : len(times)])
        watched = rows.command[run, : len(times) if self.commands.guarded else 0]
        wild = np.flatnonzero(~np.isfinite(watched).all(axis=1))
        first = min([*failed[:1], *wild[:1]], default=None)
        if first is None:
            return None
        if len(failed) and first == failed[0]:
            return int(first), np.linalg.LinAlgError(self.program(1).errors[int(rows.fault[run, first]) - 1])
        error = self.commands.fault(rows.command[run, first], float(times[first]))
        assert error is not None  # noqa: S101 - a torque is not finite there
        return int(first), error


def run_all(
    loop_program: LoopProgram, values: FloatArray, shared: FloatArray, errors: Sequence[FloatArray], start: FloatArray
) -> Rows:
    """Compute runs with the same code and number of ticks; results are bit-identical to separate runs.

    A run of Bullet's step ends in the tick in which a joint reaches a limit; see Rows.stopped.

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
    count, ticks = len(start), shared.shape[-2]
    code = loop_program.code_for(count)
    frame = code.frame(ticks, loop_program.delay, loop_program.steps)
    nq, stages = len(loop_program.commands.limits.max), len(loop_program.motion.robot.stages)
    found = Rows.new(np.empty, (count, ticks), nq, stages)._replace(stopped=np.zeros(count, dtype=bool))
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
        rows = Rows.of(frame.rows[:, :, :used].transpose(2, 0, 1), nq)
        found.q[own], found.dq[own], found.command[own], found.fault[own] = rows[:4]
        found.end_points[:, own] = rows.end_points
        if loop_program.motion.bullet is not None:
            found.stopped[own] = frame.state[long, :used] != 0.0  # see expressed_steps
    return found


def _lanes(shared: FloatArray, runs: slice) -> FloatArray:
    """Return time and path with runs on the last axis, shape (T, entries, runs); 1 if they are the same for all."""
    found: FloatArray = shared[:, :, None] if shared.ndim == 2 else shared[runs].transpose(1, 2, 0)
    return found


@dataclass(frozen=True)
class Setting:
    """Numbers, start and errors of a run, or their derivatives by a parameter.

    Attributes:
        numbers: All numbers of the closed loop, shape (k,); see LoopProgram.numbers.
        start: Initial state, shape (entries,); see Commands.start.
        errors: Errors of the positions at the ticks of each loop, shapes (n, nq), in rad.
    """

    numbers: FloatArray
    start: FloatArray
    errors: Sequence[FloatArray]


def tangents(loop_program: LoopProgram, setting: Setting, slopes: Sequence[Setting], shared: FloatArray) -> Rows:
    """Return the derivatives of a run's signals by parameters.

    Args:
        loop_program: The closed loop.
        setting: Setting of the run.
        slopes: Derivative of the setting by each parameter.
        shared: Time and path at each tick, shape (T, entries).

    Raises:
        CannotCompileError: if a control law has no compiled form.
    """
    by_number = np.array([slope.numbers for slope in slopes])
    varied: NDArray[np.bool_] = (by_number != 0.0).any(axis=0)
    kept = varied | ~np.isin(setting.numbers, _FOLDED)
    noisy = any(wrong.any() for slope in slopes for wrong in slope.errors)
    frame = _frame(loop_program, setting.numbers, kept, varied[kept], noisy, shared)
    ticks, wide, long, count = len(shared), shared.shape[1], len(setting.start), int(kept.sum())
    given, state = frame.given.shape[1] // 2, frame.state.shape[0] // 2
    frame.given[:, :wide] = shared[:, :, None]
    frame.given[:, wide:given] = loop_program.commands.measured_wrong(setting.errors, ticks)[:, :, None]
    frame.pars[:count] = setting.numbers[kept][:, None]
    parts = []
    for first in range(0, len(slopes), LANES):
        own = slopes[first : first + LANES]
        frame.state[:] = 0.0
        frame.state[:long] = setting.start[:, None]
        for lane, slope in enumerate(own):
            frame.state[state : state + long, lane] = slope.start
            frame.given[:, given + wide :, lane] = loop_program.commands.measured_wrong(slope.errors, ticks)
            frame.pars[count:, lane] = slope.numbers[kept]
        frame.call()
        rows = frame.rows[:, frame.rows.shape[1] // 2 :, : len(own)]
        parts.append(rows.transpose(2, 0, 1).copy())
    return Rows.of(np.concatenate(parts), len(loop_program.commands.limits.max))


def _frame(
    loop_program: LoopProgram,
    numbers: FloatArray,
    kept: NDArray[np.bool_],
    varied: NDArray[np.bool_],
    noisy: bool,
    shared: FloatArray,
) -> Frame:
    """Return the program with tangents, and its arrays.

    Args:
        loop_program: The closed loop.
        numbers: All numbers of the closed loop, shape (k,).
        kept: True for parameters of the code, shape (k,); the others are constants 0, 1 or -1.
        varied: True for parameters that vary.
        noisy: True if the errors of the positions vary.
        shared: Time and path at each tick, shape (T, entries).
    """
    folded = np.where(kept, np.nan, numbers)

    def express() -> Expressed:
        at, known = Slots(), iter(folded.tolist())

        def number(value: float) -> Any:
            constant = next(known)
            return at.number(value) if np.isnan(constant) else constant

        expressed = loop_program.express(at, Folding(number, number))
        return with_tangents(expressed, varies)

    def varies(space: str, index: int) -> bool:
        if space == GIVEN:
            return noisy and index >= shared.shape[1]
        return space != PARS or bool(varied[index])

    pattern = f"tangents {loop_program.pattern} {folded.tolist()} {varied.tolist()} {noisy}"
    joints = len(loop_program.commands.limits.max)
    code = program(pattern, f"the derivatives of {joints} joints", express, LANES, loop_program.commands.are_ours)
    assert code.widths[PARS] == 2 * len(varied)  # noqa: S101 - the numbers are requested in the same order
    assert code.widths[STATE] % 2 == code.widths[ROWS] % 2 == 0  # noqa: S101
    return code.frame(len(shared), loop_program.delay, loop_program.steps)
