"""Caveat rule on gains that are too high for the control period."""

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting

_LIGHT = 2.0  # times what the joints alone would have, above which the coupling is named


def _share(setting: Setting) -> float | None:
    """Return the share of what a period bears that the largest velocity gain takes."""
    return None if setting.velocity_loop is None else setting.velocity_loop.share


def _tell(value: float, setting: Setting) -> str:
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


UNSTABLE_GAINS = SettingRule("unstable_gains", "share", _share, _tell)
