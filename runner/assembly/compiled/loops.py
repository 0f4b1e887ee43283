"""Compiled control loops in a run: their rows and their ticks, with a drawn nominal model if there is one."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.assembly.compiled.commands import Commands
from runner.base.arrays import FloatArray


class DrawnRow(NamedTuple):
    """One of several nominal models that are drawn together.

    Attributes:
        commands: The control loops with all of these models.
        values: Parameters of the code with each model, shape (runs, k); see Commands.drawn_values.
        row: Index of the model.
    """

    commands: Commands
    values: FloatArray
    row: int


class Rows(NamedTuple):
    """True signals of runs, with a row for each tick; leading axes are for several runs.

    Attributes:
        q: Joint positions, shape (..., T, nq), in rad.
        dq: Joint velocities, shape (..., T, nq), in rad/s.
        command: Commands: torques within their limits in N m, or joint positions in rad, shape (..., T, nq).
        fault: Number of the failure in a compiled control law, 0 for none, shape (..., T).
        end_points: End point of each stage, shape (stages, ..., T, 3), in m.
        stopped: True for each run compiled as a whole whose code does not know the motion up to the end, shape (...).
    """

    q: FloatArray
    dq: FloatArray
    command: FloatArray
    fault: FloatArray
    end_points: FloatArray
    stopped: NDArray[np.bool_] = np.zeros(0, dtype=bool)

    @classmethod
    def of(cls, values: FloatArray, nq: int) -> "Rows":
        """Return views of rows as compiled code stores them, shape (..., T, entries); see expressed_commands."""
        q, dq, command = (values[..., part * nq : (part + 1) * nq] for part in range(3))
        points = values[..., 3 * nq + 1 :].reshape(*values.shape[:-1], -1, 3)
        return cls(q, dq, command, values[..., 3 * nq], np.moveaxis(points, -2, 0))

    @classmethod
    def new(cls, make: Callable[[tuple[int, ...]], FloatArray], lead: tuple[int, ...], nq: int, stages: int) -> "Rows":
        """Return rows of runs and ticks, shape `lead`, in arrays from `make`, such as np.zeros."""
        q, dq, command = (make((*lead, nq)) for _ in range(3))
        return cls(q, dq, command, make(lead), make((stages, *lead, 3)))


class CompiledLoops:
    """Compiled control loops in one run, tick by tick.

    Args:
        commands: The loops.
        ticks: Number of ticks.
        errors: Errors of the positions at the ticks of each loop, shape (n, nq), in rad.
        drawn: Drawn nominal model; None if the nominal model is that of the loops.

    Attributes:
        rows: Signals of the run.
    """

    def __init__(
        self, commands: Commands, ticks: int, errors: Sequence[FloatArray], drawn: DrawnRow | None = None
    ) -> None:
        program, nq = commands.program(), len(commands.limits.max)
        self._commands, self._errors, self._messages, self._drawn = commands, errors, program.errors, drawn
        self._frame, self._guarded = program.frame(ticks), commands.guarded
        self.rows = Rows.of(self._frame.rows[:, :, 0], nq)
        self._fault, self._command = self.rows.fault, self.rows.command
        self._q, self._dq = self._frame.state[:nq, 0], self._frame.state[nq : 2 * nq, 0]
        self._span, self._call = self._frame.span, self._frame.call

    def start(self, times: FloatArray, desired: FloatArray, joints: FloatArray | None, q: FloatArray) -> None:
        """Start at rest; see ControlLoops.start."""
        commands, frame, errors = self._commands, self._frame, self._errors
        wrong = commands.measured_wrong(errors, len(times))
        frame.given[:, :, 0] = np.hstack([commands.shared(times, desired, joints), wrong])
        own = self._drawn or DrawnRow(commands, commands.values[None], 0)
        first = [np.repeat(each[:1], len(own.values), axis=0) for each in errors]
        frame.state[:, 0] = own.commands.start(np.tile(q, (len(own.values), 1)), first)[own.row]
        frame.pars[:, 0] = own.values[own.row]
        self._times = times

    def update(self, k: int, q: FloatArray, dq: FloatArray) -> None:
        """Compute tick k, after the previous one; see ControlLoops.update.

        Raises:
            LinAlgError: if a control law has no solution.
            SimulationError: if a user-supplied law returns values that are not finite.
        """
        self._q[:] = q
        self._dq[:] = dq
        self._span[0], self._span[1] = k, k + 1
        self._call()
        if self._fault[k]:
            raise np.linalg.LinAlgError(self._messages[int(self._fault[k]) - 1])
        if self._guarded:
            fault = self._commands.fault(self._command[k], self._times[k])
            if fault is not None:
                raise fault
