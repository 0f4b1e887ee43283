"""Types of caveat rules: rules on signals and rules on settings."""

from collections.abc import Callable
from dataclasses import dataclass

from runner.base.arrays import FloatArray
from runner.metrics.caveats.setting import Setting
from runner.metrics.caveats.signals import Signals


@dataclass(frozen=True)
class TraceRule:
    """A rule on the signals of every repetition; what it measures springs it above its threshold.

    Attributes:
        name: Its name; its threshold stands at `caveats.NAME.KEY`.
        key: Key of its threshold.
        measure: Gives what it measures of runs, shape (..., n): a value for each joint, or one (n = 1).
        tell: Says in words what a value means, of a joint by its index.
    """

    name: str
    key: str
    measure: Callable[[Signals, Setting], FloatArray]
    tell: Callable[[float, int, Setting], str]


@dataclass(frozen=True)
class SettingRule:
    """A rule on the config alone, which holds of all repetitions alike.

    Attributes:
        name: Its name, as of a TraceRule.
        key: Key of its threshold.
        measure: Gives what it measures; None where there is nothing to measure.
        tell: Says in words what a value means.
    """

    name: str
    key: str
    measure: Callable[[Setting], float | None]
    tell: Callable[[float, Setting], str]


def percent(share: float) -> str:
    """Return a share as a text, such as "12.5 %"."""
    return f"{100.0 * share:.3g} %"


def called(joint: int, setting: Setting) -> str:
    """Return how a joint is spoken of, such as "joint q1"; a name that says so itself is enough, such as "joint2"."""
    name = setting.joint_names[joint]
    return name if name.startswith("joint") else f"joint {name}"
