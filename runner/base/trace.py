"""Traces of closed-loop runs: every signal at each control tick."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self, TypedDict

import numpy as np

from runner.base.arrays import FloatArray


@dataclass(frozen=True)
class Failure:
    """Why and where a closed loop left the domain of its equations.

    Attributes:
        reason: What happened.
        time: When, in s.
        joint: Name of the joint that left first, or None where no single one did.
    """

    reason: str
    time: float
    joint: str | None = None


@dataclass(frozen=True)
class ContactSignals:
    """Wrenches of one run, a row of force in N and moment in N m for each control tick, shapes (T, 6).

    Attributes:
        external: Of the world on the tip, moment about the tip, along the base's axes.
        felt: The same as the controller believes it; zero where none feels.
        reading: Of the wrist's sensor, about its origin, along its axes.
        load: Of world and tool on the flange, about its origin, along its axes: what the sensor is to read.
        reaction: The same as PyBullet computes it in the joint, for comparison; zero on other plants.
    """

    external: FloatArray
    felt: FloatArray
    reading: FloatArray
    load: FloatArray
    reaction: FloatArray


@dataclass(frozen=True)
class Signals:
    """Signals of one or several runs, true values unless said; shapes are those of one run, see Traces for several.

    Attributes:
        t: Times, shape (T,), in s.
        q: Joint positions, shape (T, nq), in rad.
        dq: Joint velocities, shape (T, nq), in rad/s.
        tau: Torques after the limit, held until the next row, shape (T, nq), in N m.
        end_points: End point of each stage in the base frame, shape (stages, T, 3), in m; the last is the tip.
        offsets: Offset of the tip at home from each stage's end point, shape (stages, 3), in m; the last is zero.
        stage_names: Names of the stages.
        desired: Desired tip position, velocity, acceleration, shape (T, 3, 3): rows in m, m/s, m/s^2.
        limits: Torque limit of each joint, shape (nq,), in N m; infinite where there is none.
        joint_names: Names of the joints.
        joint_units: Unit of each joint's position: rad where it turns, m where it slides. There speeds are in m/s and
            torques are forces, in N.
        tick_seconds: Wall-clock time that each tick took, shape (T - 1,), in s.
        q_command: Joint positions commanded, held until the next row, shape (T, nq), in rad; None under torques.
        contact: What the tip felt, by what is meant; None where there was nothing to feel.
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
        """Return the signals with a stage's end point in the tip's place; its home offset is taken off x_d."""
        desired = self.desired.copy()
        desired[..., 0, :] -= self.offsets[index]
        return replace(self, end_points=self.end_points[index : index + 1], desired=desired)


@dataclass(frozen=True)
class Trace(Signals):
    """Signals of one run, a row for each control tick from t = 0 to the end.

    Attributes:
        failure: Why the run ended early, or None.
        law_seconds: Wall-clock time that all control loops took in each tick, shape (T,), in s, encoders included; None
            where plant and loops are one piece of code.
    """

    failure: Failure | None = None
    law_seconds: FloatArray | None = None

    @property
    def tip(self) -> FloatArray:
        """Tip positions in the base frame, shape (T, 3), in m."""
        tip: FloatArray = self.end_points[-1]
        return tip

    def ended(self, failure: Failure) -> "Trace":
        """Return the trace of a run under torques up to the time of a failure."""
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
    """Signals of several runs, none of which failed, that have ticks, path, arm and band in common.

    A run's results are the same to the last bit in whatever company, so that what looks at several runs reduces by rows
    that lie in one piece. The runs are an axis of q, dq, tau, limits and q_command before the others, and of end_points
    after the stages; desired has it where the runs differ. The contact is that of a single run, tick_seconds of one.
    """

    @classmethod
    def of(cls, trace: Trace) -> "Traces":
        """Return one run that did not fail as a batch of one."""
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
        """Return the signals of one run or some that are not common to all."""
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
        """Tip positions by axes, shape (runs, 3, T), in m; rows of ticks in one piece."""
        return by_rows(self.end_points[-1])

    @cached_property
    def target(self) -> FloatArray:
        """Desired tip positions by axes, shape (3, T) for all alike or (runs, 3, T), in m."""
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
    """Return signals of several runs with the ticks last, in one piece, shapes (..., T, n) to (..., n, T).

    Sums and largest values over ticks are then quick, and rounded by the number of ticks alone.
    """
    return np.ascontiguousarray(values.swapaxes(-1, -2))
