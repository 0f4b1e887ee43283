"""Caveat rule on a plant that replaces the missing default plant."""

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting


def _replaced(setting: Setting) -> float | None:
    """Return 1 where the default plant is missing and another one stands in for it."""
    return None if setting.in_place_of is None else 1.0


def _tell_replaced(_: float, setting: Setting) -> str:
    return (
        f"{setting.plant} stands in for {setting.in_place_of}, the default plant, as PyBullet is not installed: bands "
        f"and verdicts are stated for {setting.in_place_of}"
    )


DEFAULT_PLANT = SettingRule("default_plant", "replaced", _replaced, _tell_replaced)
