"""A rule on what the files of the arm hold, and the arm has not."""

from runner.caveats.rule import SettingRule
from runner.caveats.setting import Setting


def _left_out(setting: Setting) -> float | None:
    """Return how many things would change the motion, stand in MJCFs, and are not taken from there."""
    return float(sum(map(len, setting.left_out.values()))) if setting.left_out else None


def _tell_left_out(value: float, setting: Setting) -> str:
    return "; ".join(f"not taken from {file}: {'; '.join(parts)}" for file, parts in setting.left_out.items())


MJCF = SettingRule("mjcf", "left_out", _left_out, _tell_left_out)
