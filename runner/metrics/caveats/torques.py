"""Caveat rules on torques at their limits: saturation and chatter."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.metrics.caveats.rule import TraceRule, called, percent
from runner.metrics.caveats.setting import Setting, Signals

_AT_LIMIT = 1.0 - 1e-12  # as in the metric saturation_fraction
_IDEAL = "kinematic"  # the plant with ideal joint motion; its torques are those that the motion would need


def _saturated(signals: Signals, setting: Setting) -> FloatArray:
    """Return the fraction of ticks at which each joint is at its torque limit, shape (..., nq)."""
    return signals.saturation


def _tell_saturated(value: float, joint: int, setting: Setting) -> str:
    name, limit = called(joint, setting), _limit(joint, setting)
    if setting.plant == _IDEAL:
        return (
            f"{name} would need its torque limit, {limit}, or more in {percent(value)} of the ticks; the plant "
            f"{setting.plant} moves it all the same"
        )
    return f"{name} is at its torque limit, {limit}, in {percent(value)} of the ticks"


def _chatter(signals: Signals, setting: Setting) -> FloatArray:
    """Return the fraction of loop ticks with a torque jump from one limit to the opposite one, shape (..., nq)."""
    if setting.plant == _IDEAL:
        return np.zeros_like(signals.saturation)
    often = np.flatnonzero(signals.saturation.reshape(-1, signals.saturation.shape[-1]).any(axis=0))
    if not len(often):
        return signals.saturation
    share: FloatArray = np.zeros_like(signals.saturation)
    tau = np.ascontiguousarray(signals.tau.swapaxes(-1, -2)[..., often, :])  # one row for each joint is faster
    if setting.speed_limits_torque:
        limits = signals.limits.swapaxes(-1, -2)[..., often, : tau.shape[-1]]
        leap = np.maximum(_AT_LIMIT * (limits[..., 1:] + limits[..., :-1]), 1e-300)  # no change is not a jump
    else:
        leap = 2.0 * _AT_LIMIT * signals.limits[..., often, None]  # largest possible change of a torque
    jumps = (np.abs(tau[..., 1:] - tau[..., :-1]) >= leap).sum(axis=-1)
    share[..., often] = jumps * setting.ticks_per_torque[often] / tau.shape[-1]
    return np.minimum(share, 1.0)


def _tell_chatter(value: float, joint: int, setting: Setting) -> str:
    name, limit = called(joint, setting), _limit(joint, setting)
    return (
        f"{name} chatters: its torque jumps from one limit, {limit}, to the opposite one "
        f"at {percent(value)} of its ticks"
    )


def _limit(joint: int, setting: Setting) -> str:
    unit = "N m" if setting.joint_units[joint] == "rad" else "N"
    return f"{setting.torque_limits[joint]:.4g} {unit}{' at rest' if setting.speed_limits_torque else ''}"


SATURATION = TraceRule("saturation", _saturated, _tell_saturated)
CHATTER = TraceRule("chatter", _chatter, _tell_chatter)
