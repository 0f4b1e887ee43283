"""Caveat rule on unstable contact with the environment."""

import numpy as np

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting

_DIGITS = 6  # of the radius; an axis without a spring has an eigenvalue of 1 but for rounding


def _radius(setting: Setting) -> float | None:
    """Return the spectral radius of contact behind servos or under a law that pushes; None where there is none."""
    if setting.touch is not None:
        return round(setting.touch, _DIGITS)
    if setting.contact is None:
        return None
    from runner.plants.servo_contact_stability import (
        contact_radius,  # the store knows rules, and is imported without rigid bodies
    )

    try:
        return round(contact_radius(setting.contact), _DIGITS)
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


UNSTABLE_CONTACT = SettingRule("unstable_contact", "radius", _radius, _tell_radius)
