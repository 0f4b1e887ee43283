"""Compiled closed loops with tangents: derivatives of a run's signals by several parameters at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.simulation.compiled.closed_loop import LoopProgram
from runner.symbolic.arm import NoConstantFolding
from runner.symbolic.code import GIVEN, PARS, ROWS, STATE, Slots
from runner.symbolic.program import LANES, Expressed, Frame, program
from runner.symbolic.tangent import with_tangents

_FOLDED = (0.0, 1.0, -1.0)


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


@dataclass(frozen=True)
class Motions:
    """Signals of runs, or their derivatives by parameters; the runs or parameters are on the axis `runs`.

    Attributes:
        q: Joint positions, shape (runs, T, nq), in rad.
        dq: Joint velocities, shape (runs, T, nq), in rad/s.
        torque: Commanded torques within their limits, shape (runs, T, nq), in N m.
        end_points: End point of each stage, shape (stages, runs, T, 3), in m.
    """

    q: FloatArray
    dq: FloatArray
    torque: FloatArray
    end_points: FloatArray


def tangents(loop_program: LoopProgram, setting: Setting, slopes: Sequence[Setting], shared: FloatArray) -> Motions:
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
    return _motions(np.concatenate(parts), len(loop_program.commands.limits))


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

        expressed = loop_program.express(at, NoConstantFolding(number))
        return with_tangents(expressed, varies)

    def varies(space: str, index: int) -> bool:
        if space == GIVEN:
            return noisy and index >= shared.shape[1]
        return space != PARS or bool(varied[index])

    pattern = f"tangents {loop_program.pattern} {folded.tolist()} {varied.tolist()} {noisy}"
    joints = len(loop_program.commands.limits)
    code = program(pattern, f"the derivatives of {joints} joints", express, LANES, loop_program.commands.are_ours)
    assert code.widths[PARS] == 2 * len(varied)  # noqa: S101 - the numbers are requested in the same order
    assert code.widths[STATE] % 2 == code.widths[ROWS] % 2 == 0  # noqa: S101
    return code.frame(len(shared), loop_program.delay, loop_program.steps)


def _motions(rows: FloatArray, nq: int) -> Motions:
    """Return the signals in rows, shape (runs, T, entries)."""
    q, dq, torque = (rows[:, :, part * nq : (part + 1) * nq] for part in range(3))
    points = rows[:, :, 3 * nq + 1 :].reshape(*rows.shape[:2], -1, 3).transpose(2, 0, 1, 3)
    return Motions(q, dq, torque, points)
