"""Rows of a log for the fit: the filtered equations of each joint, and checks of what the log can tell."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.identification.friction_kinds import JointSpeeds
from runner.identification.parameters import ParameterSum
from runner.recordings.columns_map import FixedPayload, Signal, stacked
from runner.recordings.equations import EvenRows, motion_of
from runner.recordings.recording import Recording
from runner.recordings.smoothing import derivative, evenly
from runner.robots.model import RobotModel

SHORTEST = 2.0  # s
"""Shortest log that is read, in s."""


@dataclass(frozen=True)
class LogRows:
    """Equations of all joints at the rows of a log.

    Attributes:
        name: Name of the log.
        motion: Rows at which the equations are evaluated.
        Y: Columns of the base parameters, shape (N, nq, number of sums).
        base: The same behind the low-pass at the kept rows, shape (M, nq, number of sums).
        payload: Torques of the known payload, shape (N, nq), in N m.
    """

    name: str
    motion: EvenRows
    Y: FloatArray
    base: FloatArray
    payload: FloatArray

    @cached_property
    def speed(self) -> FloatArray:
        """Filtered speeds, shape (M, nq), in rad/s."""
        return self.motion.behind_filter(self.motion.dq)

    @cached_property
    def sign(self) -> FloatArray:
        """Filtered direction of motion, shape (M, nq)."""
        return self.motion.behind_filter(self.motion.signs)

    @cached_property
    def carried(self) -> FloatArray:
        """Filtered torques of the known payload, shape (M, nq), in N m."""
        return self.motion.behind_filter(self.payload)

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """True where a joint moves in one direction and its torque can be used, shape (M, nq)."""
        return np.column_stack(
            [
                self.motion.moving(joint, self.speed[:, joint], self.sign[:, joint]) & (not self.motion.unusable[joint])
                for joint in range(self.motion.model.nq)
            ]
        )

    def torque(self, delay: float) -> FloatArray:
        """Return the filtered torques as they were a delay later, shape (M, nq), in N m."""
        motion = self.motion
        torques: FloatArray = np.nan_to_num(motion.torques)
        if delay:
            t = np.asarray(motion.period * np.arange(len(torques)), dtype=np.float64)
            torques = evenly(t, torques, np.clip(t + delay, t[0], t[-1]))
        return motion.behind_filter(torques)

    def slope(self, torques: FloatArray) -> FloatArray:
        """Return the filtered derivative of torques, shapes (N, nq) to (M, nq), in N m/s."""
        return self.motion.behind_filter(derivative(torques, self.motion.period))

    def speeds(self, joint: int, load: FloatArray) -> JointSpeeds:
        """Return the signals that the friction of a joint depends on."""
        motion = self.motion
        return JointSpeeds(motion.dq[:, joint], motion.signs[:, joint], load, float(motion.fastest[joint]))


def read_rows(
    recording: Recording,
    model: RobotModel,
    sums: Sequence[ParameterSum],
    rotors: bool,
    frequency: float,
    payload: FixedPayload | None = None,
) -> LogRows:
    """Return the equations at the rows of a log.

    Args:
        recording: The log.
        model: The arm.
        sums: Base parameters.
        rotors: Whether the torques turn the rotors.
        frequency: Cut-off of the low-pass on both sides, in Hz.
        payload: What the arm carried; None for nothing.

    Raises:
        RunnerError: if the log is too short, or lacks positions or torques.
    """
    joints = model.joint_names
    for kind in ("position", "torque"):
        missing = [joint for joint in joints if Signal(kind, joint) not in recording.signals]
        if missing and (kind == "position" or len(missing) == len(joints)):
            raise RunnerError(f"{recording.path}: no {kind} of {', '.join(missing)} is recorded. Needed: all joints.")
    if recording.duration < SHORTEST:
        raise RunnerError(f"{recording.path}: lasts {recording.duration:.3g} s. Needed: {SHORTEST:g} s or more.")
    first = recording.torque_shift
    count = int((recording.duration - first) / recording.period + 1e-6) + 1
    times = np.minimum(first + recording.period * np.arange(count), recording.t[-1])

    def rows_of(kind: str) -> FloatArray | None:
        found = stacked(recording.signals, [Signal(kind, joint) for joint in joints])  # type: ignore[arg-type]
        return None if found is None else evenly(recording.t, found, times)

    torques = [
        recording.torque_at(signal, times) if signal in recording.signals else np.full(len(times), np.nan)
        for signal in (Signal("torque", joint) for joint in joints)
    ]
    q = rows_of("position")
    assert q is not None  # noqa: S101 - checked above
    motion = motion_of(
        model, q, np.column_stack(torques), recording.period, frequency, rows_of("velocity"), rows_of("acceleration")
    )
    if not len(motion.kept):
        raise RunnerError(f"{recording.path}: lasts {recording.duration:.3g} s, too short for a filter of "
                          f"{frequency:g} Hz. Needed: a longer log.")  # fmt: skip
    return log_rows(motion, sums, rotors, recording.path.name, payload)


def log_rows(
    motion: EvenRows, sums: Sequence[ParameterSum], rotors: bool, name: str, payload: FixedPayload | None = None
) -> LogRows:
    """Return the equations at rows; see read_rows."""
    Y = motion.regressor()
    if rotors:
        Y = np.concatenate([Y, motion.ddq[:, :, None] * np.eye(motion.model.nq)], axis=2)
    Y = Y[:, :, [each.column for each in sums]]
    base = np.stack([motion.behind_filter(Y[:, joint]) for joint in range(motion.model.nq)], axis=1)
    carried = np.zeros_like(motion.q) if payload is None or not payload.mass else payload_torques(motion, payload)
    return LogRows(name, motion, Y, base, carried)


def payload_torques(motion: EvenRows, payload: FixedPayload) -> FloatArray:
    """Return the torques of a mass that is fixed at the tip, shape (N, nq), in N m."""
    pin_model, data = payload.fixed_on(motion.model).separate()
    torques = np.array([pin.rnea(pin_model, data, *row) for row in zip(motion.q, motion.dq, motion.ddq, strict=True)])
    return np.asarray(torques - motion.rigid_torques())
