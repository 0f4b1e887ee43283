"""Caveat rules on controllers: unstable gains, unstable contact, and runs shorter than the time constants."""

import math

import numpy as np

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting

_LIGHT = 2.0  # times what the joints alone would have, above which the coupling is named


def _gain_share(setting: Setting) -> float | None:
    """Return the share of what a period bears that the largest velocity gain takes."""
    return None if setting.velocity_loop is None else setting.velocity_loop.share


def _tell_gains(value: float, setting: Setting) -> str:
    coupling = 1.0 if setting.velocity_loop is None else setting.velocity_loop.coupling
    text = (
        "by its linear map the velocity loop is unstable at this period, at home or along the desired joints, unless a "
        f"torque is at its limit: h lambda_max(M^-1 K_v) / 2 is {value:.3g}, and stable below 1; take "
        f"controller.natural_frequency or controller.period {value:.3g} times smaller or more"
    )
    if coupling < _LIGHT:
        return text
    return (
        f"{text}, or robot.armature: joints move others that are heavier, and lambda_max(M^-1 diag M) is {coupling:.3g}"
    )


UNSTABLE_GAINS = SettingRule("unstable_gains", _gain_share, _tell_gains)


_ENOUGH = 3.0  # time constants, in which an exponential does 95 % of its way
_DIGITS = 6  # of the share; two equal poles are found to half of the digits


def _time_share(setting: Setting) -> float | None:
    """Return the share of the run that the law's slowest part takes; None where no law says its time constants."""
    return None if setting.slowest is None else round(_ENOUGH * setting.slowest.seconds / setting.duration, _DIGITS)


def _tell_horizon(value: float, setting: Setting) -> str:
    part, seconds = ("", 0.0) if setting.slowest is None else (setting.slowest.part, setting.slowest.seconds)
    return (
        f"the law's {part} has a time constant of {seconds:.3g} s, and the run ends after {setting.duration:g} s: it "
        f"is judged before it has done its work, which takes {_ENOUGH:g} time constants; take "
        f"duration={_rounded_up(value * setting.duration):g} or more"
    )


def _rounded_up(value: float) -> float:
    """Return a number that is not below another, of two digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit) * unit


SHORT_HORIZON = SettingRule("short_horizon", _time_share, _tell_horizon)


_DIGITS_OF_RADIUS = 6  # of the radius; an axis without a spring has an eigenvalue of 1 but for rounding


def _radius(setting: Setting) -> float | None:
    """Return the spectral radius of contact behind servos or under a law that pushes; None where there is none."""
    if setting.touch is not None:
        return round(setting.touch, _DIGITS_OF_RADIUS)
    if setting.contact is None:
        return None
    from runner.plants.servo_contact_stability import (
        contact_radius,  # the store knows rules, and is imported without rigid bodies
    )

    try:
        return round(contact_radius(setting.contact), _DIGITS_OF_RADIUS)
    except np.linalg.LinAlgError:  # at a singular posture
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
