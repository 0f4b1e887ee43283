"""Types of caveat rules, and of the caveats that they find."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from runner.base.arrays import FloatArray
from runner.metrics.caveats.setting import Setting, Signals


@dataclass(frozen=True)
class TraceRule:
    """A rule on the signals of every repetition; what it measures springs it above its threshold.

    Attributes:
        name: Its name; its threshold is in runner/config/judgement.py.
        measure: Gives what it measures of runs, shape (..., n): a value for each joint, or one (n = 1).
        tell: Says in words what a value means, of a joint by its index.
    """

    name: str
    measure: Callable[[Signals, Setting], FloatArray]
    tell: Callable[[float, int, Setting], str]


@dataclass(frozen=True)
class SettingRule:
    """A rule on the config alone, which holds of all repetitions alike.

    Attributes:
        name: Its name, as of a TraceRule.
        measure: Gives what it measures; None where there is nothing to measure.
        tell: Says in words what a value means.
    """

    name: str
    measure: Callable[[Setting], float | None]
    tell: Callable[[float, Setting], str]


def percent(share: float) -> str:
    """Return a share as a text, such as "12.5 %"."""
    return f"{100.0 * share:.3g} %"


def called(joint: int, setting: Setting) -> str:
    """Return how a joint is spoken of, such as "joint q1"; a name that says so itself is enough, such as "joint2"."""
    name = setting.joint_names[joint]
    return name if name.startswith("joint") else f"joint {name}"


@dataclass(frozen=True)
class Caveat:
    """One reason why a result may not be what it seems.

    Attributes:
        rule: Name of the rule, and of the group of its threshold.
        text: What it found, in words.
        value: What it measured, the worst over joints and repetitions; above the rule's threshold.
    """

    rule: str
    text: str
    value: float


@dataclass(frozen=True)
class Found:
    """All that the rules found in a run.

    Attributes:
        caveats: One for each rule that was sprung.
        digest: Digest of the rules' source.
        thresholds: What a run had to exceed, by rule and key.
    """

    caveats: Sequence[Caveat]
    digest: str
    thresholds: Mapping[str, Mapping[str, float]]

    def record(self) -> dict[str, Any]:
        """Return what is stored of it."""
        return {
            "caveats": [asdict(caveat) for caveat in self.caveats],
            "caveat_rules": {"digest": self.digest, "thresholds": self.thresholds},
        }
