"""The record of one run: every signal at every tick, and why it ended early."""

import time

import numpy as np

from runner.errors import SimulationError
from runner.loop.closed_loop import ClosedLoop
from runner.loop.contact import Contact
from runner.robots.robot import end_points
from runner.trace import Failure, FloatArray, Trace

# Above this the equations still hold but no arm does: a run that gets there has diverged.
DIVERGED_SPEED = 1e6  # rad/s, or m/s of a joint that slides
_CHECK_EVERY = 64  # ticks between two looks for divergence, which the metrics never see


class Recorder:
    """Rows of every signal, one for each tick and one for the end.

    Args:
        closed: The closed loop whose run is recorded.

    Attributes:
        times: Time of each row, shape (T,), in s.
        desired: Desired motion of the tip, shape (T, 3, 3): position, velocity, acceleration.
        command: What the loops ask for now, shape (nq,): torques in N m, or joint positions in rad.
        commands: What they asked for in each tick, shape (T, nq).
        torques: Torques of a plant that follows positions, shape (T, nq), in N m.
    """

    def __init__(self, closed: ClosedLoop) -> None:
        rows, nq = closed.ticks + 1, closed.robot.model.nq
        self._closed, self._plant, self._now = closed, closed.plant, time.perf_counter_ns
        self.times: FloatArray = np.arange(rows, dtype=np.float64) * closed.tick
        self.desired: FloatArray = np.zeros((rows, 3, 3))
        self.command: FloatArray = closed.q_start.copy() if closed.commands == "position" else np.zeros(nq)
        self._q, self._dq, self.commands, self.torques = (np.zeros((rows, nq)) for _ in range(4))
        self._q[0] = closed.q_start
        self._clock = np.zeros(rows, dtype=np.int64)
        self._kept = slice(0, rows)
        self._failure: Failure | None = None

    def observe(self, k: int) -> tuple[FloatArray, FloatArray]:
        """Keep the plant's true state in tick k, and return it: joint positions and velocities, shapes (nq,)."""
        self._clock[k] = self._now()
        self._q[k] = q = self._plant.q
        self._dq[k] = dq = self._plant.dq
        return q, dq

    def keep_command(self, k: int) -> None:
        """Keep what the loops ask for in tick k.

        Raises:
            SimulationError: if the run has diverged; it is looked for now and then.
        """
        self.commands[k] = self.command
        if k % _CHECK_EVERY == 0:
            self.check_divergence(k)

    def check_divergence(self, k: int) -> None:
        """Look for divergence in the rows before tick k, and in its own.

        Raises:
            SimulationError: at the first row with a joint that is not finite, or faster than any arm's.
        """
        first = max(0, k - _CHECK_EVERY)
        q, dq = self._q[first : k + 1], self._dq[first : k + 1]
        wild = ~(np.isfinite(q) & (np.abs(dq) < DIVERGED_SPEED))
        if wild.any():
            row = int(np.argmax(wild.any(axis=1)))
            joint, model = int(np.argmax(wild[row])), self._closed.robot.model
            reason = f"diverged: not finite or above {DIVERGED_SPEED:g} {model.joint_units[joint]}/s"
            raise SimulationError(reason, float(self.times[first + row]), model.joint_names[joint])

    def stop(self, k: int, error: Exception) -> None:
        """End the record with what was raised in tick k, or with divergence before it, its likely cause."""
        failure = Failure(error.reason if isinstance(error, SimulationError) else str(error), float(self.times[k]))
        try:
            self.check_divergence(k)
        except SimulationError as diverged:
            failure = Failure(diverged.reason, diverged.time, diverged.joint)
        self._failure = failure
        self._kept = slice(0, int(np.searchsorted(self.times, failure.time)) + 1)

    def trace(self, contact: Contact | None) -> Trace:
        """Return the record, with what the tip felt."""
        closed, kept = self._closed, self._kept
        positions = closed.commands == "position"
        acted = self.commands[np.maximum(np.arange(len(self.times)) - closed.delay, 0)]
        home = end_points(closed.robot, closed.robot.home[None], closed.parallel)[:, 0]
        return Trace(
            t=self.times[kept],
            q=self._q[kept],
            dq=self._dq[kept],
            tau=(self.torques if positions else acted)[kept],
            q_command=self.commands[kept] if positions else None,
            contact=None if contact is None else contact.signals(kept),
            end_points=end_points(closed.robot, self._q[kept], closed.parallel),
            offsets=home[-1] - home,
            stage_names=closed.robot.stage_names,
            desired=self.desired[kept],
            limits=closed.limits,
            joint_names=closed.robot.model.joint_names,
            joint_units=closed.robot.model.joint_units,
            tick_seconds=np.diff(self._clock[kept]) * 1e-9,
            failure=self._failure,
        )
