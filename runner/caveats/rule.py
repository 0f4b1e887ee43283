"""Types of caveat rules, and of the caveats that they find."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from runner.base.arrays import FloatArray
from runner.caveats.setting import RunSetting, RunSignals


@dataclass(frozen=True)
class TraceRule:
    """Rule on the signals of every repetition, triggered if its value exceeds its threshold.

    Attributes:
        name: Name of the rule; its threshold is in runner/config/judgement.py.
        measure: Function of runs; returns values of shape (..., n), one for each joint, or a single one (n = 1).
        tell: Function of a value and the index of a joint; returns the message.
    """

    name: str
    measure: Callable[[RunSignals, RunSetting], FloatArray]
    tell: Callable[[float, int, RunSetting], str]


@dataclass(frozen=True)
class SettingRule:
    """Rule on the config only, with the same result for all repetitions.

    Attributes:
        name: Name of the rule, as in TraceRule.
        measure: Function that returns the value; None if the rule does not apply.
        tell: Function of a value; returns the message.
    """

    name: str
    measure: Callable[[RunSetting], float | None]
    tell: Callable[[float, RunSetting], str]


def percent(share: float) -> str:
    """Return a fraction as a percentage, such as "12.5 %"."""
    return f"{100.0 * share:.3g} %"


def called(joint: int, setting: RunSetting) -> str:
    """Return the name of a joint in a message: "joint q1", or the name itself if it starts with joint, as "joint2"."""
    name = setting.joint_names[joint]
    return name if name.startswith("joint") else f"joint {name}"


@dataclass(frozen=True)
class Caveat:
    """Warning that a result may be misleading.

    Attributes:
        rule: Name of the rule, which is also the name of the group of its threshold.
        text: Message of the rule.
        value: Value of the rule, the largest over joints and repetitions; above the threshold.
    """

    rule: str
    text: str
    value: float


@dataclass(frozen=True)
class Found:
    """Results of all rules for a run.

    Attributes:
        caveats: One caveat for each rule that was triggered.
        digest: Digest of the source of the rules.
        thresholds: Thresholds by rule and key.
    """

    caveats: Sequence[Caveat]
    digest: str
    thresholds: Mapping[str, Mapping[str, float]]

    def record(self) -> dict[str, Any]:
        """Return the results in the form that is stored."""
        return {
            "caveats": [asdict(caveat) for caveat in self.caveats],
            "caveat_rules": {"digest": self.digest, "thresholds": self.thresholds},
        }
