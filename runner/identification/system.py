"""Linear equations of all joints and logs for one kind of friction, and the columns that these logs can tell apart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.identification.friction_kinds import TERMS, FrictionKind, friction_columns
from runner.identification.log_rows import LogRows


@dataclass(frozen=True)
class Layout:
    """Order of the columns: base parameters, friction of one joint after another, torque constants, and the delay.

    Attributes:
        kind: The kind of friction.
        base: Number of base parameters.
        nq: Number of joints.
        currents: Joints whose torque constants are fitted.
    """

    kind: FrictionKind
    base: int
    nq: int
    currents: Sequence[int] = ()

    @property
    def constants(self) -> int:
        """Place of the first torque constant."""
        return self.base + self.nq * len(TERMS[self.kind])

    @property
    def delay(self) -> int:
        """Place of the delay."""
        return self.constants + len(self.currents)

    def friction(self, joint: int) -> slice:
        """Return the places of the friction of a joint."""
        many = len(TERMS[self.kind])
        return slice(self.base + joint * many, self.base + (joint + 1) * many)


@dataclass(frozen=True)
class State:
    """A point about which the equations are linear.

    Attributes:
        layout: Order of the values.
        values: Values of all columns, shape (n,); those of torque constants and delay are corrections, as shares and
            in s.
        delay: Delay of the torques, in s.
        shapes: v_s of each joint's friction as a share of its largest speed, shape (nq,).
        scales: The torque constant of each joint over that of the column map, shape (nq,).
    """

    layout: Layout
    values: FloatArray
    delay: float
    shapes: FloatArray
    scales: FloatArray

    def rigid(self, rows: LogRows) -> FloatArray:
        """Return the torques of links, rotors and payload, shape (N, nq), in N m."""
        torques: FloatArray = rows.Y @ self.values[: self.layout.base] + rows.payload
        return torques

    def loads(self, rows: LogRows) -> FloatArray:
        """Return the magnitude of the torques of links, rotors and payload, shape (N, nq), in N m."""
        loads: FloatArray = np.abs(self.rigid(rows))
        return loads

    def friction_columns(self, rows: LogRows, joint: int, load: FloatArray) -> FloatArray:
        """Return the columns of a joint's friction before the low-pass, shape (N, terms)."""
        return friction_columns(self.layout.kind, rows.speeds(joint, load), float(self.shapes[joint]))


@dataclass(frozen=True)
class System:
    """Rows of equations X p = y.

    Attributes:
        layout: Order of the columns.
        X: Shape (R, n).
        y: Torques without those of known payloads, shape (R,), in N m.
        carried: Torques of known payloads, shape (R,), in N m.
        joint: Joint of each row, shape (R,).
        log: Number of the log of each row, shape (R,).
        row: Number of the kept row of its log, shape (R,).
        time: Time on its log's clock, shape (R,), in s.
        moving: True for rows of the fit, shape (R,): the joint moves in one direction, and its torque can be used.
        period: Time between two rows of each log, in s.
    """

    layout: Layout
    X: FloatArray
    y: FloatArray
    carried: FloatArray
    joint: NDArray[np.intp]
    log: NDArray[np.intp]
    row: NDArray[np.intp]
    time: FloatArray
    moving: NDArray[np.bool_]
    period: Sequence[float]


def linear_system(logs: Sequence[LogRows], state: State, corrected: bool) -> System:
    """Return the equations of some logs about a state.

    Args:
        logs: Rows of the logs.
        state: The point about which they are linear.
        corrected: Whether delay and torque constants have columns; otherwise these are zero.
    """
    layout = state.layout
    parts = []
    for number, rows in enumerate(logs):
        y, raw = rows.torque(state.delay) * state.scales - rows.carried, state.rigid(rows)
        loads = np.abs(raw)
        columns = [state.friction_columns(rows, joint, loads[:, joint]) for joint in range(layout.nq)]
        for joint, own in enumerate(columns):
            raw[:, joint] += own @ state.values[layout.friction(joint)]
        friction = rows.motion.behind_filter(np.hstack(columns))
        slope = rows.slope(raw) if corrected else np.zeros_like(y)
        whole = rows.motion.behind_filter(raw) if corrected and layout.currents else np.zeros_like(y)
        many = len(y)
        for joint in range(layout.nq):
            if rows.motion.unusable[joint]:
                continue
            X, of_joint = np.zeros((many, layout.delay + 1)), layout.friction(joint)
            X[:, : layout.base] = rows.base[:, joint]
            X[:, of_joint] = friction[:, of_joint.start - layout.base : of_joint.stop - layout.base]
            X[:, layout.delay] = -slope[:, joint]
            if joint in layout.currents:  # of the modelled torque: the recorded one would add its noise
                X[:, layout.constants + layout.currents.index(joint)] = -whole[:, joint]
            numbers = (np.full(many, joint), np.full(many, number), np.arange(many))
            parts.append((X, y[:, joint], rows.carried[:, joint], *numbers, rows.motion.times, rows.moving[:, joint]))
    X, y, carry, joint_of, log_of, row_of, time, moving = (np.concatenate(each) for each in zip(*parts, strict=True))
    periods = [float(np.median(np.diff(rows.motion.times))) if len(rows.motion.times) > 1 else 1.0 for rows in logs]
    return System(layout, X, y, carry, joint_of, log_of, row_of, time, moving, periods)
