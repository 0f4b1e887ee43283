"""Caveat rule on runs that are too short for the time constants of their controller."""

import math

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting

_ENOUGH = 3.0  # time constants, in which an exponential does 95 % of its way
_DIGITS = 6  # of the share; two equal poles are found to half of the digits


def _share(setting: Setting) -> float | None:
    """Return the share of the run that the law's slowest part takes; None where no law says its time constants."""
    return None if setting.slowest is None else round(_ENOUGH * setting.slowest.seconds / setting.duration, _DIGITS)


def _tell(value: float, setting: Setting) -> str:
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


SHORT_HORIZON = SettingRule("short_horizon", "share", _share, _tell)
