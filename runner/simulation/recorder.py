"""Recorder of one run: every signal at every tick, the active commands, and the reason for an early end."""

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.base.trace import Failure, Trace
from runner.robots.robot import end_points
from runner.simulation.closed_loop import ClosedLoop
from runner.simulation.contact import Contact
from runner.simulation.failures import find_divergence


class CommandTiming:
    """The acting commands of each tick.

    A loop's command is stored in the row of its tick, and in each later row until the loop's next command.

    Args:
        joints: Joints of each loop.
        rows: Tick whose command acts in each tick, of each loop, shapes (T,).
    """

    def __init__(self, joints: Sequence[slice], rows: Sequence[NDArray[np.int64]]) -> None:
        self._joints, self._rows = joints, rows
        self._alike = all(np.array_equal(rows[0], own) for own in rows[1:])

    def at(self, commands: FloatArray, k: int) -> FloatArray:
        """Return the acting commands in tick k, shape (nq,), from the commands of each tick, shape (T, nq)."""
        if self._alike:
            acting: FloatArray = commands[self._rows[0][k]]
            return acting
        return np.concatenate([commands[own[k], joints] for joints, own in zip(self._joints, self._rows, strict=True)])

    def throughout(self, commands: FloatArray) -> FloatArray:
        """Return the acting commands in every tick, shape (T, nq)."""
        parts = [commands[own, joints] for joints, own in zip(self._joints, self._rows, strict=True)]
        return np.concatenate(parts, axis=1)


def constant_delay(joints: int, delay: int, ticks: int) -> CommandTiming:
    """Return a timing in which all commands act after the same delay, in ticks."""
    return CommandTiming([slice(0, joints)], [np.maximum(np.arange(ticks) - delay, 0)])


CHECK_EVERY = 64
"""Ticks between two checks for divergence."""


class Recorder:
    """Rows of every signal, one for each tick and one for the end.

    Args:
        closed: The closed loop of the run.
        timing: Command that acts in each tick.

    Attributes:
        times: Time of each row, shape (T,), in s.
        desired: Desired motion of the tip, shape (T, 3, 3): position, velocity, acceleration.
        joints: Desired motion of the joints, shape (T, 3, nq), in rad, rad/s, rad/s^2; None if only the tip's motion is
            given.
        command: Current commands of the loops, shape (nq,): torques in N m, or joint positions in rad.
        commands: Commands in each tick, shape (T, nq), in the same unit.
        timing: Command that acts in each tick.
        torques: Torques of a plant that follows positions, shape (T, nq), in N m.
        clock: Time at which each tick began, shape (T,), in ns.
        asked: Duration of the control loops in each tick, shape (T,), in ns; None if it was not measured.
        now: Clock of these times, in ns.
        q: True joint positions in each tick, shape (T, nq), in rad.
        dq: True joint velocities in each tick, shape (T, nq), in rad/s.
        end_points: End point of each stage, shape (stages, T, 3), in m; None until they are computed.
    """

    def __init__(self, closed: ClosedLoop, timing: CommandTiming) -> None:
        rows, nq = closed.ticks + 1, closed.robot.model.nq
        self._closed, self._plant, self.timing, self.now = closed, closed.plant, timing, time.perf_counter_ns
        self.times: FloatArray = np.arange(rows, dtype=np.float64) * closed.tick
        self.desired: FloatArray = np.zeros((rows, 3, 3))
        self.joints: FloatArray | None = None
        self.command: FloatArray = closed.q_start.copy() if closed.commands == "position" else np.zeros(nq)
        self.q, self.dq, self.commands, self.torques = (np.zeros((rows, nq)) for _ in range(4))
        self.q[0] = closed.q_start
        self.end_points: FloatArray | None = None
        self._bends = closed.plant.bends
        if self._bends:
            self.end_points = np.zeros((len(closed.robot.stages), rows, 3))
        self._checked = 0
        self.clock = np.zeros(rows, dtype=np.int64)
        self.asked: NDArray[np.int64] | None = None
        self._kept = slice(0, rows)
        self._failure: Failure | None = None

    def observe(self, k: int) -> tuple[FloatArray, FloatArray]:
        """Store and return the plant's true state in tick k: joint positions and velocities, shapes (nq,)."""
        self.clock[k] = self.now()
        self.q[k] = q = self._plant.q
        self.dq[k] = dq = self._plant.dq
        if self._bends and self.end_points is not None:
            self.end_points[:, k] = self._plant.end_points()
        return q, dq

    def keep_command(self, k: int) -> None:
        """Store the commands of tick k.

        Raises:
            SimulationError: if the run has diverged, which is checked every CHECK_EVERY ticks.
        """
        self.commands[k] = self.command
        if k % CHECK_EVERY == 0:
            self.check_divergence(k)

    def check_divergence(self, k: int) -> None:
        """Check for divergence in the rows since the last check, up to tick k.

        Raises:
            SimulationError: at the first row with a joint that is not finite or too fast.
        """
        first = self._checked
        found = find_divergence(
            self.q[first : k + 1], self.dq[first : k + 1], self.times[first : k + 1], self._closed.robot.model
        )
        if found is not None:
            raise SimulationError(found.reason, found.time, found.joint)
        self._checked = k

    def stop(self, k: int, error: Exception) -> None:
        """End the record with an error in tick k, or with an earlier divergence, its likely cause."""
        failure = Failure(error.reason if isinstance(error, SimulationError) else str(error), float(self.times[k]))
        try:
            self.check_divergence(k)
        except SimulationError as diverged:
            failure = Failure(diverged.reason, diverged.time, diverged.joint)
        self.end(failure)

    def end(self, failure: Failure | None) -> None:
        """End the record with a failure, at its time; None if the run succeeded."""
        self._failure = failure
        if failure is not None:
            self._kept = slice(0, int(np.searchsorted(self.times, failure.time)) + 1)

    def trace(self, contact: Contact | None) -> Trace:
        """Return the record as a trace, with the signals of the contact."""
        closed, kept = self._closed, self._kept
        positions = closed.commands == "position"
        acted = self.timing.throughout(self.commands)
        home = end_points(closed.robot, closed.robot.home[None], closed.ignore_base_rotation)[:, 0]
        return Trace(
            t=self.times[kept],
            q=self.q[kept],
            dq=self.dq[kept],
            tau=(self.torques if positions else acted)[kept],
            q_command=self.commands[kept] if positions else None,
            contact=None if contact is None else contact.signals(kept),
            end_points=self._end_points(kept),
            offsets=home[-1] - home,
            stage_names=closed.robot.stage_names,
            desired=self.desired[kept],
            limits=closed.limits,
            joint_names=closed.robot.model.joint_names,
            joint_units=closed.robot.model.joint_units,
            tick_seconds=np.diff(self.clock[kept]) * 1e-9,
            failure=self._failure,
            law_seconds=None if self.asked is None else np.asarray(self.asked[kept] * 1e-9),
        )

    def _end_points(self, kept: slice) -> FloatArray:
        if self.end_points is not None:
            return self.end_points[:, kept]
        return end_points(self._closed.robot, self.q[kept], self._closed.ignore_base_rotation)
