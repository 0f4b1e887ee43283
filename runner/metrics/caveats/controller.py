"""Caveat rules on controllers: unstable gains, unstable contact, and runs shorter than the time constants."""

import math

import numpy as np

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting

_LIGHT = 2.0  # ratio to uncoupled joints above which the message contains the coupling


def _gain_share(setting: Setting) -> float | None:
    """Return the ratio of the largest velocity gain to the stability limit of its period."""
    return None if setting.velocity_loop is None else setting.velocity_loop.share


def _tell_gains(value: float, setting: Setting) -> str:
    coupling = 1.0 if setting.velocity_loop is None else setting.velocity_loop.coupling
    text = (
        "the velocity loop is unstable: controller.natural_frequency or controller.period is at least "
        f"{value:.3g} times too large (h lambda_max(M^-1 K_v) / 2 is {value:.3g} at home or along the desired joints, "
        "and stable below 1, if no torque is at its limit)"
    )
    if coupling < _LIGHT:
        return text
    return (
        f"{text}; a larger robot.armature helps, too, as joints move others that are heavier: "
        f"lambda_max(M^-1 diag M) is {coupling:.3g}"
    )


UNSTABLE_GAINS = SettingRule("unstable_gains", _gain_share, _tell_gains)


_ENOUGH = 3.0  # time constants, after which an exponential has decayed by 95 %
_DIGITS = 6  # of the fraction; numerical double poles are accurate to half of the digits only


def _time_share(setting: Setting) -> float | None:
    """Return the ratio of three times the slowest time constant to the run; None if no time constant is known."""
    return None if setting.slowest is None else round(_ENOUGH * setting.slowest.seconds / setting.duration, _DIGITS)


def _tell_horizon(value: float, setting: Setting) -> str:
    part, seconds = ("", 0.0) if setting.slowest is None else (setting.slowest.part, setting.slowest.seconds)
    return (
        f"the law's {part} has a time constant of {seconds:.3g} s, and the run ends after {setting.duration:g} s: it "
        f"is judged before it has done its work, which takes {_ENOUGH:g} time constants; take "
        f"duration={_rounded_up(value * setting.duration):g} or more"
    )


def _rounded_up(value: float) -> float:
    """Return a number rounded up to two digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit) * unit


SHORT_HORIZON = SettingRule("short_horizon", _time_share, _tell_horizon)


_DIGITS_OF_RADIUS = 6  # of the radius; an axis without a spring has an eigenvalue of 1 up to rounding


def _radius(setting: Setting) -> float | None:
    """Return the spectral radius of contact with servos or under a hybrid force law; None without such a contact."""
    if setting.touch is not None:
        return round(setting.touch, _DIGITS_OF_RADIUS)
    if setting.contact is None:
        return None
    from runner.plants.servo_contact_stability import (
        contact_radius,  # imported here, because the store imports the rules without rigid-body models
    )

    try:
        return round(contact_radius(setting.contact), _DIGITS_OF_RADIUS)
    except np.linalg.LinAlgError:  # in a singular configuration
        return None


def _tell_radius(value: float, setting: Setting) -> str:
    if setting.touch is not None:
        return (
            "by the linear map of force law and wall at the start, contact with the wall is unstable: a small motion "
            f"grows {value:.4g} times in each controller.period; take a softer wall, a shorter controller.period, or "
            "less controller.force_gain"
        )
    return (
        f"by the linear map of servos, arm, filter and wall at the start, contact with the wall is unstable: a small "
        f"motion grows {value:.4g} times in each controller.period, unless a joint is at its torque limit; take a "
        "softer wall, a shorter controller.period, or more controller.damping or controller.mass"
    )


UNSTABLE_CONTACT = SettingRule("unstable_contact", _radius, _tell_radius)
