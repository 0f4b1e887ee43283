"""Caveat rules on the config: load, measurements, nominal model, gains, contact, duration, plant and robot file."""

import math
from typing import TYPE_CHECKING

import numpy as np

from runner.caveats.rule import SettingRule
from runner.caveats.setting import RunSetting

if TYPE_CHECKING:
    from runner.robots.mismatch import MismatchConfig

_FACTORS = ("mass", "centre_of_mass", "length", "gravity")
_OF_LINK = ("mass", "centre_of_mass", "inertia")
_LIGHT = 2.0  # ratio to uncoupled joints above which the message contains the coupling
_ENOUGH = 3.0  # time constants, after which an exponential has decayed by 95 %
_DIGITS_OF_RADIUS = 6  # of the radius; an axis without a spring has an eigenvalue of 1 up to rounding
_DIGITS = 6  # of the fraction; numerical double poles are accurate to half of the digits only


def _overload(setting: RunSetting) -> float | None:
    """Return the ratio of tool and payload to the rated payload; None if no rating is given."""
    robot = setting.robot
    return None if robot.rated_payload is None else robot.burden / robot.rated_payload


def _tell_overload(value: float, setting: RunSetting) -> str:
    robot = setting.robot
    what = "the payload weighs" if robot.tool is None else "tool and payload weigh"
    rating = f"the {robot.rated_payload:g} kg that {robot.name} is rated for"
    return f"{what} {robot.burden:.4g} kg, {value:.3g} times {rating}"


def _lifted(setting: RunSetting) -> float | None:
    """Return the payload, in kg, if a joint has no torque limit."""
    return None if all(map(math.isfinite, setting.torque_limits.tolist())) else setting.robot.payload.largest


def _tell_lifted(value: float, setting: RunSetting) -> str:
    endless = [name for name, limit in zip(setting.joint_names, setting.torque_limits, strict=True) if limit == np.inf]
    which = "no joint" if len(endless) == len(setting.joint_names) else f"not joint {', '.join(endless)}"
    return f"{setting.robot.name} lifts {value:.4g} kg, and would lift anything: {which} has a torque limit"


NO_EFFORT_LIMIT = SettingRule("no_effort_limit", _lifted, _tell_lifted)


def _noise_beside_exact(setting: RunSetting) -> float | None:
    return setting.noise if setting.torques else None  # laws that command positions do not use velocities


def _tell_noise(value: float, setting: RunSetting) -> str:
    return (
        f"controllers measure positions to {value:.3g} rad and velocities exactly (noise.velocity: exact), which no "
        "encoder gives: torques and saturation may be larger"
    )


def _fixed_error(setting: RunSetting) -> float | None:
    """Return the largest relative error of the nominal model, if it is the same in several repetitions."""
    mismatch = setting.mismatch
    if mismatch is None or mismatch.varies or setting.repetitions == 1:
        return None
    return max(abs(mismatch.payload) / setting.mass, *(abs(value - 1.0) for value in _factors(mismatch).values()))


def _tell_fixed(value: float, setting: RunSetting) -> str:
    mismatch = setting.mismatch
    wrong = [] if mismatch is None else [name for name, value in _factors(mismatch).items() if value != 1.0]
    wrong += ["payload"] if mismatch is not None and mismatch.payload else []
    return (
        f"the {setting.repetitions} repetitions vary only noise: mismatch.{', mismatch.'.join(wrong)} "
        f"{'is' if len(wrong) == 1 else 'are'} the same in all (mismatch.spread: 0), so that their intervals say "
        "nothing of other wrong models"
    )


def _factors(mismatch: "MismatchConfig") -> dict[str, float]:
    """Return the fixed factors of the nominal model, by their keys in `mismatch`."""
    of_links = {f"link.{name}.{term}": getattr(link, term) for name, link in mismatch.link.items() for term in _OF_LINK}
    return {name: getattr(mismatch, name) for name in _FACTORS} | of_links


FIXED_MISMATCH = SettingRule("fixed_mismatch", _fixed_error, _tell_fixed)


def _tell_gains(value: float, setting: RunSetting) -> str:
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


def _time_share(setting: RunSetting) -> float | None:
    """Return the ratio of three times the slowest time constant to the run; None if no time constant is known."""
    return None if setting.slowest is None else round(_ENOUGH * setting.slowest.seconds / setting.duration, _DIGITS)


def _tell_horizon(value: float, setting: RunSetting) -> str:
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


def _radius(setting: RunSetting) -> float | None:
    """Return the spectral radius of contact with servos or under a hybrid force law; None without such a contact."""
    if setting.touch is not None:
        return round(setting.touch, _DIGITS_OF_RADIUS)
    if setting.contact is None:
        return None
    # imported here, because the store imports the rules without rigid-body models
    from runner.caveats.servo_contact_stability import contact_radius

    try:
        return round(contact_radius(setting.contact), _DIGITS_OF_RADIUS)
    except np.linalg.LinAlgError:  # in a singular configuration
        return None


def _tell_radius(value: float, setting: RunSetting) -> str:
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


def _tell_left_out(value: float, setting: RunSetting) -> str:
    return "; ".join(f"not taken from {file}: {'; '.join(parts)}" for file, parts in setting.left_out.items())


SETTING_RULES = (
    SettingRule("overload", _overload, _tell_overload),
    SettingRule("no_effort_limit", _lifted, _tell_lifted),
    SettingRule("exact_velocity", _noise_beside_exact, _tell_noise),
    SettingRule("fixed_mismatch", _fixed_error, _tell_fixed),
    SettingRule("unstable_gains", lambda setting: setting.velocity_loop and setting.velocity_loop.share, _tell_gains),
    SettingRule("unstable_contact", _radius, _tell_radius),
    SettingRule("short_horizon", _time_share, _tell_horizon),
    SettingRule("robot_file", lambda setting: float(sum(map(len, setting.left_out.values()))) or None, _tell_left_out),
)
"""Rules in the order of output."""
