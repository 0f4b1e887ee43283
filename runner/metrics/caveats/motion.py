"""Caveat rules on the motion: large tracking error, and joints beyond their position limits."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import by_rows
from runner.metrics.caveats.rule import TraceRule, called, percent
from runner.metrics.caveats.setting import Setting, Signals

_SIZED = 60  # most rows, including the last one, used for the size of a motion
_END = 10  # for a motion to a goal, the last tenth of the run is evaluated


def _unfollowed(signals: Signals, setting: Setting) -> FloatArray:
    """Return the ratio of the largest tip error to the size of the motion, shape (..., 1).

    The size is the largest distance of the desired position from the start of the tip. For a motion to a goal, whose
    error starts at that size, only the last tenth counts. The ratio is 0 if the arm must stay or comply.
    """
    if setting.complies:
        return np.zeros((*signals.q.shape[:-2], 1))
    desired, tip, start = signals.desired, signals.tip, signals.tip[..., :1, :]
    if not setting.tracked:
        last = tip.shape[-2] // _END + 1
        desired, tip = desired[..., -last:, :], tip[..., -last:, :]
    every = desired.shape[-2] // _SIZED + 1
    size = _longest(desired[..., ::-every, :] - start)
    band = setting.robot.settling_band
    share: FloatArray = _longest(desired - tip) / np.maximum(size, band) * (size > band)
    return share[..., None]


def _longest(vectors: FloatArray) -> FloatArray:
    """Return the largest norm of the vectors in rows, shapes (..., T, 3) to (...)."""
    squares = vectors * vectors
    squared = squares[..., 0] + squares[..., 1]
    squared += squares[..., 2]
    longest: FloatArray = np.sqrt(squared.max(axis=-1))
    return longest


def _tell_unfollowed(value: float, joint: int, setting: Setting) -> str:
    if setting.tracked:
        return f"the arm did not follow: the tip's error reaches {percent(value)} of the size of its motion"
    return f"the arm did not follow: at the end the tip is still {percent(value)} of its way from the goal"


def _beyond(signals: Signals, setting: Setting) -> FloatArray:
    """Return the excess of each joint over its position limits, shape (..., nq), in rad; negative within the limits."""
    lower, upper = setting.position_limits
    q = by_rows(signals.q)
    excess: FloatArray = np.maximum(lower - q.min(axis=-1), q.max(axis=-1) - upper)
    return excess


def _tell_beyond(value: float, joint: int, setting: Setting) -> str:
    return (
        f"{called(joint, setting)} goes {value:.3g} {setting.joint_units[joint]} beyond its position limits, "
        f"at which the plant {setting.plant} does not hold it"
    )


DID_NOT_FOLLOW = TraceRule("did_not_follow", _unfollowed, _tell_unfollowed)
JOINT_LIMITS = TraceRule("joint_limits", _beyond, _tell_beyond)
