"""Traces of closed-loop runs: every signal at each control tick."""

from dataclasses import dataclass, replace
from functools import cached_property

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

    def during(self, ticks: slice) -> "ContactSignals":
        """Return some of the ticks."""
        return ContactSignals(*(signal[ticks] for signal in vars(self).values()))


@dataclass(frozen=True)
class Trace:
    """True signals of one run or of several, with a row for each control tick from t = 0 to the end.

    The shapes are for one run. Several runs have ticks, path, arm and settling band in common, and no failures. Their
    axis is the first one of q, dq, tau, limits and q_command, and the second one of end_points, after the stages.
    desired has it as its first axis if the desired motions differ. contact and tick_seconds are of one run.
    `traces[i]` is one of several runs, and `trace[None]` is one run as a batch of one.

    Results of a run must not depend on the other runs, not even by rounding. Code for several runs therefore reduces
    along contiguous rows.

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
        limits: Torque limit of each joint, shape (nq,), in N m; infinite without a limit. Shape (T, nq) if a limit
            depends on the speed.
        joint_names: Names of the joints.
        joint_units: Unit of the position of each joint: rad for revolute joints, m for prismatic joints. The speed of a
            prismatic joint is in m/s and its torque is a force, in N.
        tick_seconds: Wall-clock time of each tick, shape (T - 1,), in s.
        q_command: Commanded joint positions, constant until the next row, shape (T, nq), in rad; None if the controller
            commands torques.
        contact: Wrenches of the run; None without an external wrench.
        failure: Failure that ended the run early, or None.
        law_seconds: Wall-clock time of all control loops in each tick, including encoders, shape (T,), in s; None if
            plant and loops are compiled together.
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
    failure: Failure | None = None
    law_seconds: FloatArray | None = None

    def __getitem__(self, runs: int | slice | list[int] | None) -> "Trace":
        """Return one or some of several runs; `trace[None]` is one run as a batch of one."""
        return replace(
            self,
            q=self.q[runs],
            dq=self.dq[runs],
            tau=self.tau[runs],
            end_points=self.end_points[:, runs],
            desired=self.desired if self.desired.ndim == 3 else self.desired[runs],
            limits=self.limits[runs],
            q_command=None if self.q_command is None else self.q_command[runs],
        )

    def ended(self, failure: Failure) -> "Trace":
        """Return the trace of one run up to the time of a failure."""
        rows = int(np.searchsorted(self.t, failure.time)) + 1
        return replace(self.during(slice(rows)), failure=failure)

    def during(self, ticks: slice) -> "Trace":
        """Return some of the ticks."""
        t = self.t[ticks]
        return replace(
            self,
            t=t,
            q=self.q[..., ticks, :],
            dq=self.dq[..., ticks, :],
            tau=self.tau[..., ticks, :],
            end_points=self.end_points[..., ticks, :],
            desired=self.desired[..., ticks, :, :],
            limits=self.limits[..., ticks, :] if self.limits.ndim == self.q.ndim else self.limits,
            tick_seconds=self.tick_seconds[: len(t) - 1],
            q_command=None if self.q_command is None else self.q_command[..., ticks, :],
            contact=None if self.contact is None else self.contact.during(ticks),
            law_seconds=None if self.law_seconds is None else self.law_seconds[ticks],
        )

    def at_stage(self, index: int) -> "Trace":
        """Return the signals with the end point of a stage as the tip; x_d is reduced by its home offset."""
        desired = self.desired.copy()
        desired[..., 0, :] -= self.offsets[index]
        return replace(self, end_points=self.end_points[index : index + 1], desired=desired)

    @property
    def tip(self) -> FloatArray:
        """Tip positions in the base frame, shape (T, 3), in m."""
        tip: FloatArray = self.end_points[-1]
        return tip

    @property
    def error(self) -> FloatArray:
        """Tip error, desired minus actual, shape (T, 3), in m."""
        difference: FloatArray = self.desired[..., 0, :] - self.tip
        return difference

    @cached_property
    def tip_by_axis(self) -> FloatArray:
        """Tip positions, shape (..., 3, T), in m, with contiguous rows."""
        return by_rows(self.tip)

    @cached_property
    def target_by_axis(self) -> FloatArray:
        """Desired tip positions, shape (3, T) if common to all runs, else (runs, 3, T), in m, with contiguous rows."""
        return by_rows(self.desired[..., 0, :])

    @cached_property
    def error_by_axis(self) -> FloatArray:
        """Tip error, desired minus actual, shape (..., 3, T), in m, with contiguous rows."""
        difference: FloatArray = self.target_by_axis - self.tip_by_axis
        return difference


def by_rows(values: FloatArray) -> FloatArray:
    """Return contiguous signals of several runs with the ticks last, shapes (..., T, n) to (..., n, T).

    Sums and maxima over ticks are then fast, and their rounding depends on the number of ticks only.
    """
    return np.ascontiguousarray(values.swapaxes(-1, -2))
