"""Caveat rules on signals: tracking error, limits of joint positions and speeds, and torques at their limits."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import by_rows
from runner.caveats.rule import TraceRule, called, percent
from runner.caveats.setting import IDEAL, RunSetting, RunSignals

_AT_LIMIT = 1.0 - 1e-12  # as in the metric saturation_fraction
_SIZED = 60  # most rows, including the last one, used for the size of a motion
_DIGITS_OF_SPEED = 9  # a speed at its limit may exceed it by rounding
_ON_STOP = 1e-4  # rad, or m
_END = 10  # for a motion to a goal, the last tenth of the run is evaluated


def _unfollowed(signals: RunSignals, setting: RunSetting) -> FloatArray:
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


def _tell_unfollowed(value: float, joint: int, setting: RunSetting) -> str:
    if setting.tracked:
        return f"the arm did not follow: the tip's error reaches {percent(value)} of the size of its motion"
    return f"the arm did not follow: at the end the tip is still {percent(value)} of its way from the goal"


def _beyond(signals: RunSignals, setting: RunSetting) -> FloatArray:
    """Return the excess of each joint over its position limits, shape (..., nq), in rad; negative within the limits."""
    lower, upper = setting.position_limits
    q = by_rows(signals.q)
    excess: FloatArray = np.maximum(lower - q.min(axis=-1), q.max(axis=-1) - upper)
    return excess


def _tell_beyond(value: float, joint: int, setting: RunSetting) -> str:
    where = f"{called(joint, setting)} goes {value:.3g} {setting.joint_units[joint]} beyond its position limits"
    if setting.stops:
        return f"{where}: the stops of the plant {setting.plant} give way"
    return f"{where}, at which the plant {setting.plant} does not hold it"


def _stopped(signals: RunSignals, setting: RunSetting) -> FloatArray:
    """Return the fraction of ticks at which each joint is on a stop, shape (..., nq); 0 for plants without stops."""
    if not setting.stops:
        return np.zeros_like(signals.saturation)
    lower, upper = setting.position_limits
    share: FloatArray = ((signals.q <= lower + _ON_STOP) | (signals.q >= upper - _ON_STOP)).mean(axis=-2)
    return share


def _tell_stopped(value: float, joint: int, setting: RunSetting) -> str:
    return (
        f"{called(joint, setting)} is on a stop of the plant {setting.plant}, at a position limit, in "
        f"{percent(value)} of the ticks; other plants may let it pass"
    )


def _speeding(signals: RunSignals, setting: RunSetting) -> FloatArray:
    """Return the largest speed of each joint as a fraction of its limit, shape (..., nq); 0 without a limit."""
    limits = np.where(setting.velocity_limits > 0.0, setting.velocity_limits, np.inf)  # a limit of 0 is a missing one
    fastest = np.abs(by_rows(signals.dq)).max(axis=-1)
    share: FloatArray = np.round(fastest / limits, _DIGITS_OF_SPEED)
    return share


def _tell_speeding(value: float, joint: int, setting: RunSetting) -> str:
    limit = f"{setting.velocity_limits[joint]:.4g} {setting.joint_units[joint]}/s"
    return (
        f"{called(joint, setting)} moves at {value:.3g} times its speed limit, {limit}, which the plant "
        f"{setting.plant} does not enforce; take a slower motion"
    )


def _tell_saturated(value: float, joint: int, setting: RunSetting) -> str:
    name, limit = called(joint, setting), _limit(joint, setting)
    if setting.plant == IDEAL:
        return (
            f"{name} would need its torque limit, {limit}, or more in {percent(value)} of the ticks; the plant "
            f"{setting.plant} moves it all the same"
        )
    return f"{name} is at its torque limit, {limit}, in {percent(value)} of the ticks"


def _chatter(signals: RunSignals, setting: RunSetting) -> FloatArray:
    """Return the fraction of loop ticks with a torque jump from one limit to the opposite one, shape (..., nq)."""
    if setting.plant == IDEAL:
        return np.zeros_like(signals.saturation)
    often = np.flatnonzero(signals.saturation.reshape(-1, signals.saturation.shape[-1]).any(axis=0))
    if not len(often):
        return signals.saturation
    share: FloatArray = np.zeros_like(signals.saturation)
    tau = np.ascontiguousarray(signals.tau.swapaxes(-1, -2)[..., often, :])  # one row for each joint is faster
    if setting.speed_limits_torque:
        limits = signals.limits.swapaxes(-1, -2)[..., often, : tau.shape[-1]]
        leap = _AT_LIMIT * (limits[..., 1:] + limits[..., :-1])
    else:
        leap = 2.0 * _AT_LIMIT * signals.limits[..., often, None]  # largest possible change of a torque
    leap = np.maximum(leap, 1e-300)  # no change is not a jump
    jumps = (np.abs(tau[..., 1:] - tau[..., :-1]) >= leap).sum(axis=-1)
    share[..., often] = jumps * setting.ticks_per_torque[often] / tau.shape[-1]
    return np.minimum(share, 1.0)


def _tell_chatter(value: float, joint: int, setting: RunSetting) -> str:
    name, limit = called(joint, setting), _limit(joint, setting)
    return (
        f"{name} chatters: its torque jumps from one limit, {limit}, to the opposite one "
        f"at {percent(value)} of its ticks"
    )


def _limit(joint: int, setting: RunSetting) -> str:
    unit = "N m" if setting.joint_units[joint] == "rad" else "N"
    return f"{setting.torque_limits[joint]:.4g} {unit}{' at rest' if setting.speed_limits_torque else ''}"


TRACE_RULES = (
    TraceRule("did_not_follow", _unfollowed, _tell_unfollowed),
    TraceRule("saturation", lambda signals, setting: signals.saturation, _tell_saturated),
    TraceRule("chatter", _chatter, _tell_chatter),
    TraceRule("joint_limits", _beyond, _tell_beyond),
    TraceRule("joint_stops", _stopped, _tell_stopped),
    TraceRule("joint_speed", _speeding, _tell_speeding),
)
"""Rules in the order of output."""
