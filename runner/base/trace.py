"""Traces of closed-loop runs: every signal at each control tick."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self, TypedDict

import numpy as np

from runner.base.arrays import FloatArray


@dataclass(frozen=True)
class Failure:
    """Failure of a closed loop that left the domain of its equations.

    Attributes:
        reason: Reason of the failure.
        time: Time of the failure, in s.
        joint: Name of the joint that failed first, or None if no single joint failed.
    """

    reason: str
    time: float
    joint: str | None = None


@dataclass(frozen=True)
class ContactSignals:
    """Wrenches of one run, with a row of force in N and moment in N m for each control tick, shapes (T, 6).

    Attributes:
        external: Wrench of the environment on the tip, moment about the tip, along the axes of the base.
        felt: The same wrench as used by the controller; zero if no controller uses it.
        reading: Reading of the wrist sensor, about the sensor's origin, along the sensor's axes.
        load: Wrench of environment and tool on the flange, about its origin, along its axes; the ideal reading.
        reaction: The same load as computed by PyBullet in the joint, for comparison; zero on other plants.
    """

    external: FloatArray
    felt: FloatArray
    reading: FloatArray
    load: FloatArray
    reaction: FloatArray


@dataclass(frozen=True)
class Signals:
    """Signals of one or several runs, as true values; shapes are for one run, see Traces for several runs.

    Attributes:
        t: Times, shape (T,), in s.
        q: Joint positions, shape (T, nq), in rad.
        dq: Joint velocities, shape (T, nq), in rad/s.
        tau: Limited torques, constant until the next row, shape (T, nq), in N m.
        end_points: End point of each stage in the base frame, shape (stages, T, 3), in m; the last is the tip.
        offsets: Offset of the tip from the end point of each stage at the home configuration, shape (stages, 3), in m;
            the last is zero.
        stage_names: Names of the stages.
        desired: Desired tip position, velocity and acceleration, shape (T, 3, 3), in m, m/s and m/s^2.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite without a limit.
        joint_names: Names of the joints.
        joint_units: Unit of the position of each joint: rad for revolute joints, m for prismatic joints. The speed of a
            prismatic joint is in m/s and its torque is a force, in N.
        tick_seconds: Wall-clock time of each tick, shape (T - 1,), in s.
        q_command: Commanded joint positions, constant until the next row, shape (T, nq), in rad; None if the controller
            commands torques.
        contact: Wrenches of the run; None without an external wrench.
    """

    t: FloatArray
    q: FloatArray
    dq: FloatArray
    tau: FloatArray
    end_points: FloatArray
    offsets: FloatArray
    stage_names: tuple[str, ...]
    desired: FloatArray
    limits: FloatArray
    joint_names: tuple[str, ...]
    joint_units: tuple[str, ...]
    tick_seconds: FloatArray
    q_command: FloatArray | None = None
    contact: ContactSignals | None = None

    def at_stage(self, index: int) -> Self:
        """Return the signals with the end point of a stage as the tip; x_d is reduced by its home offset."""
        desired = self.desired.copy()
        desired[..., 0, :] -= self.offsets[index]
        return replace(self, end_points=self.end_points[index : index + 1], desired=desired)


@dataclass(frozen=True)
class Trace(Signals):
    """Signals of one run, with a row for each control tick from t = 0 to the end.

    Attributes:
        failure: Failure that ended the run early, or None.
        law_seconds: Wall-clock time of all control loops in each tick, including encoders, shape (T,), in s; None if
            plant and loops are compiled together.
    """

    failure: Failure | None = None
    law_seconds: FloatArray | None = None

    @property
    def tip(self) -> FloatArray:
        """Tip positions in the base frame, shape (T, 3), in m."""
        tip: FloatArray = self.end_points[-1]
        return tip

    def ended(self, failure: Failure) -> "Trace":
        """Return the trace of a torque-controlled run up to the time of a failure."""
        rows = int(np.searchsorted(self.t, failure.time)) + 1
        return replace(
            self,
            t=self.t[:rows],
            q=self.q[:rows],
            dq=self.dq[:rows],
            tau=self.tau[:rows],
            end_points=self.end_points[:, :rows],
            desired=self.desired[:rows],
            tick_seconds=self.tick_seconds[: rows - 1],
            failure=failure,
        )

    @property
    def error(self) -> FloatArray:
        """Tip error, desired minus actual, shape (T, 3), in m."""
        difference: FloatArray = self.desired[:, 0] - self.tip
        return difference


@dataclass(frozen=True)
class Traces(Signals):
    """Signals of several runs without failures that have ticks, path, arm and settling band in common.

    Results of a run must not depend on the other runs, not even by rounding. Code for several runs therefore reduces
    along contiguous rows. The axis of the runs is the first axis of q, dq, tau, limits and q_command, and the second
    one of end_points, after the stages. desired has it if the desired motions differ. contact and tick_seconds are of
    one run.
    """

    @classmethod
    def of(cls, trace: Trace) -> "Traces":
        """Return a run without a failure as a batch of one run."""
        return cls(
            **_in_common(trace),
            q=trace.q[None],
            dq=trace.dq[None],
            tau=trace.tau[None],
            end_points=trace.end_points[:, None],
            desired=trace.desired,
            limits=trace.limits[None],
            q_command=None if trace.q_command is None else trace.q_command[None],
        )

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.q)

    def run(self, index: int) -> Trace:
        """Return the trace of one run."""
        return Trace(**_in_common(self), **self._own(index))

    def part(self, own: slice | list[int]) -> "Traces":
        """Return some of the runs."""
        return replace(self, **self._own(own))

    def _own(self, runs: int | slice | list[int]) -> "_Own":
        """Return the signals of some runs that are not common to all runs."""
        return {
            "q": self.q[runs],
            "dq": self.dq[runs],
            "tau": self.tau[runs],
            "end_points": self.end_points[:, runs],
            "desired": self.desired if self.desired.ndim == 3 else self.desired[runs],
            "limits": self.limits[runs],
            "q_command": None if self.q_command is None else self.q_command[runs],
        }

    @cached_property
    def tip(self) -> FloatArray:
        """Tip positions by axes, shape (runs, 3, T), in m, with contiguous rows."""
        return by_rows(self.end_points[-1])

    @cached_property
    def target(self) -> FloatArray:
        """Desired tip positions by axes, shape (3, T) if common to all runs or (runs, 3, T), in m."""
        return by_rows(self.desired[..., 0, :])

    @cached_property
    def error(self) -> FloatArray:
        """Tip error, desired minus actual, by axes, shape (runs, 3, T), in m."""
        difference: FloatArray = self.target - self.tip
        return difference


class _Common(TypedDict):
    t: FloatArray
    offsets: FloatArray
    stage_names: tuple[str, ...]
    joint_names: tuple[str, ...]
    joint_units: tuple[str, ...]
    tick_seconds: FloatArray
    contact: ContactSignals | None


class _Own(TypedDict):
    q: FloatArray
    dq: FloatArray
    tau: FloatArray
    end_points: FloatArray
    desired: FloatArray
    limits: FloatArray
    q_command: FloatArray | None


def _in_common(signals: Signals) -> _Common:
    """Return the signals that several runs have in common."""
    return {
        "t": signals.t,
        "offsets": signals.offsets,
        "stage_names": signals.stage_names,
        "joint_names": signals.joint_names,
        "joint_units": signals.joint_units,
        "tick_seconds": signals.tick_seconds,
        "contact": signals.contact,
    }


def by_rows(values: FloatArray) -> FloatArray:
    """Return contiguous signals of several runs with the ticks last, shapes (..., T, n) to (..., n, T).

    Sums and maxima over ticks are then fast, and their rounding depends on the number of ticks only.
    """
    return np.ascontiguousarray(values.swapaxes(-1, -2))
