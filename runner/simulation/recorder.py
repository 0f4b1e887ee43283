"""Recorder of one run: every signal at every tick, the active commands, and the reason for an early end."""

import time
from collections.abc import Sequence
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.compiled.loops import Rows
from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.base.trace import ContactSignals, Failure, Trace
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, end_points

# No arm reaches this speed, so a run above it has diverged.
DIVERGED_SPEED = 1e6  # rad/s, or m/s for a prismatic joint
CHECK_EVERY = 64
"""Ticks between two checks for divergence."""


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


class Recorder:
    """Rows of every signal, one for each tick and one for the end.

    Args:
        closed: The closed loop of the run.
        timing: Command that acts in each tick.
        rows: Rows of states, commands and end points. The loop stores states in them, and the control laws commands.

    Attributes:
        times: Time of each row, shape (T,), in s.
        desired: Desired motion of the tip, shape (T, 3, 3): position, velocity, acceleration.
        timing: Command that acts in each tick.
        rows: Rows of states, commands and end points.
        torques: Torques of a plant that follows positions, shape (T, nq), in N m; None for a plant that takes torques.
        speeds: Speeds of the motors in each tick, shape (T, nq), in rad/s.
        clock: Time at which each tick began, shape (T,), in ns.
        asked: Duration of the control loops in each tick, shape (T,), in ns.
        now: Clock of these times, in ns.
        contact: Signals of the contact; None without contact.
    """

    def __init__(self, closed: ClosedLoop, timing: CommandTiming, rows: Rows) -> None:
        ticks = closed.ticks + 1
        self._closed, self.timing, self.rows, self.now = closed, timing, rows, time.perf_counter_ns
        self.times: FloatArray = np.arange(ticks, dtype=np.float64) * closed.tick
        self.desired: FloatArray = np.zeros((ticks, 3, 3))
        self.torques = np.zeros_like(rows.command) if closed.commands == "position" else None
        self.speeds = rows.dq if closed.motor_side is None else np.zeros_like(rows.dq)
        self.rows.q[0] = closed.q_start
        self.clock, self.asked = (np.zeros(ticks, dtype=np.int64) for _ in range(2))
        self.contact: ContactSignals | None = None
        self._checked = 0
        self._failure: Failure | None = None

    def check_divergence(self, k: int) -> None:
        """Check for divergence in the rows since the last check, up to tick k.

        Raises:
            SimulationError: at the first row with a joint that is not finite or too fast.
        """
        some = slice(self._checked, k + 1)
        found = find_divergence(self.rows.q[some], self.rows.dq[some], self.times[some], self._closed.robot.model)
        if found is not None:
            raise SimulationError(found.reason, found.time, found.joint)
        self._checked = k

    def stop(self, k: int, error: Exception) -> None:
        """End the record with an error in tick k, or with an earlier divergence, its likely cause."""
        self._failure = failure_of(error, float(self.times[k]))
        try:
            self.check_divergence(k)
        except SimulationError as diverged:
            self._failure = Failure(diverged.reason, diverged.time, diverged.joint)

    def trace(self) -> Trace:
        """Return the record as a trace."""
        closed, rows, failure = self._closed, self.rows, self._failure
        acted = self.timing.throughout(rows.command)
        if closed.compiled is None and not closed.plant.bends:
            kept = slice(len(self.times) if failure is None else int(np.searchsorted(self.times, failure.time)) + 1)
            rows.end_points[:, kept] = end_points(closed.robot, rows.q[kept], closed.ignore_base_rotation)
        trace = Trace(
            t=self.times,
            q=rows.q,
            dq=rows.dq,
            tau=acted if self.torques is None else self.torques,
            q_command=None if self.torques is None else rows.command,
            contact=self.contact,
            end_points=rows.end_points,
            desired=self.desired,
            limits=self._applied_limits(),
            tick_seconds=np.diff(self.clock) * 1e-9,
            law_seconds=np.asarray(self.asked * 1e-9),
            **describe(closed.robot, closed.ignore_base_rotation),
        )
        return trace if failure is None else trace.ended(failure)

    def _applied_limits(self) -> FloatArray:
        closed, rows = self._closed, self.rows
        if self.torques is not None:
            return closed.limits.applied(self.torques, rows.dq)
        held = [(loop.joints, closed.every(loop)) for loop in closed.loops]
        limits = closed.limits.applied(rows.command, self.speeds, held)
        return self.timing.throughout(limits) if closed.limits.depend_on_speed else limits


class RobotFields(TypedDict):
    """Fields of a trace that describe the robot; see Trace."""

    offsets: FloatArray
    stage_names: tuple[str, ...]
    joint_names: tuple[str, ...]
    joint_units: tuple[str, ...]


def describe(robot: Robot, ignore_base_rotation: bool) -> RobotFields:
    """Return the fields of a trace that describe the robot."""
    home = end_points(robot, robot.home[None], ignore_base_rotation)[:, 0]
    names, model = robot.stage_names, robot.model
    return RobotFields(
        offsets=home[-1] - home, stage_names=names, joint_names=model.joint_names, joint_units=model.joint_units
    )


def find_divergence(q: FloatArray, dq: FloatArray, times: FloatArray, model: RobotModel) -> Failure | None:
    """Return the first row of q or dq, shapes (T, nq), that is not finite or too fast; None if there is none."""
    wild = ~(np.isfinite(q) & (np.abs(dq) < DIVERGED_SPEED))
    if not wild.any():
        return None
    row = int(np.argmax(wild.any(axis=1)))
    joint = int(np.argmax(wild[row]))
    reason = f"diverged: not finite or above {DIVERGED_SPEED:g} {model.joint_units[joint]}/s"
    return Failure(reason, float(times[row]), model.joint_names[joint])


def failure_of(error: Exception, time: float) -> Failure:
    """Return the failure of an error at a time, in s."""
    return Failure(error.reason if isinstance(error, SimulationError) else str(error), time)
