"""Caveat rules on measurements and the nominal model: exact velocities, and fixed model error."""

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting

_FACTORS = ("mass", "centre_of_mass", "length", "gravity")
_OF_LINK = ("mass", "centre_of_mass", "inertia")


def _noise_beside_exact(setting: Setting) -> float | None:
    """Return the largest noise or resolution of a measured joint position, in rad, if velocities are exact."""
    noise = setting.noise
    if noise.velocity != "exact" or not setting.torques:  # laws that command positions do not use velocities
        return None
    drawn = 0.0 if noise.distribution == "none" else max(noise.position.tolist())
    return float(max(drawn, *noise.resolution.tolist()))


def _tell_noise(value: float, setting: Setting) -> str:
    return (
        f"controllers measure positions to {value:.3g} rad and velocities exactly (noise.velocity: exact), which no "
        "encoder gives: torques and saturation may be larger"
    )


def _fixed_error(setting: Setting) -> float | None:
    """Return the largest relative error of the nominal model, if it is the same in several repetitions."""
    if setting.mismatch.varies or setting.repetitions == 1:
        return None
    return max(
        abs(setting.mismatch.payload) / setting.mass, *(abs(value - 1.0) for value in _factors(setting).values())
    )


def _tell_fixed(value: float, setting: Setting) -> str:
    wrong = [name for name, value in _factors(setting).items() if value != 1.0]
    wrong += ["payload"] if setting.mismatch.payload else []
    return (
        f"the {setting.repetitions} repetitions vary noise alone: mismatch.{', mismatch.'.join(wrong)} "
        f"{'is' if len(wrong) == 1 else 'are'} the same in all (mismatch.spread: 0), so that their intervals say "
        "nothing of other wrong models"
    )


def _factors(setting: Setting) -> dict[str, float]:
    """Return the fixed factors of the nominal model, by their keys in `mismatch`."""
    mismatch = setting.mismatch
    of_links = {f"link.{name}.{term}": getattr(link, term) for name, link in mismatch.link.items() for term in _OF_LINK}
    return {name: getattr(mismatch, name) for name in _FACTORS} | of_links


EXACT_VELOCITY = SettingRule("exact_velocity", _noise_beside_exact, _tell_noise)
FIXED_MISMATCH = SettingRule("fixed_mismatch", _fixed_error, _tell_fixed)
