"""The rules at work: every repetition is looked at, and the worst is told."""

from dataclasses import dataclass

import numpy as np

from runner.caveats.caveat import Caveat, Found
from runner.caveats.registry import SETTING_RULES, TRACE_RULES, rules_digest
from runner.caveats.rule import SettingRule, TraceRule
from runner.caveats.setting import Setting
from runner.caveats.signals import Signals
from runner.config.caveats import CaveatsConfig


@dataclass
class _Worst:
    """The worst that a rule measured so far: value, joint, and how many repetitions sprung it."""

    value: float = -np.inf
    joint: int = 0
    sprung: int = 0


class Watch:
    """Looks at the repetitions of a run, one after another or several at once.

    Args:
        setting: The run's setting.
        thresholds: What it must exceed.
    """

    def __init__(self, setting: Setting, thresholds: CaveatsConfig) -> None:
        self._setting, self._thresholds = setting, thresholds
        self._limits = [(rule, _threshold(rule, thresholds)) for rule in TRACE_RULES]
        self._worst = {rule.name: _Worst() for rule in TRACE_RULES}
        self._seen = 0

    def look(self, signals: Signals) -> None:
        """Look at the signals of one repetition, or of several that have an axis in front."""
        runs = signals.runs
        self._seen += runs
        for rule, threshold in self._limits:
            values = rule.measure(signals, self._setting)
            value, worst = float(values.max()), self._worst[rule.name]
            if value > threshold:
                worst.sprung += 1 if runs == 1 else int(np.count_nonzero(values.max(axis=-1) > threshold))
                if value > worst.value:
                    worst.value, worst.joint = value, int(np.argmax(values)) % values.shape[-1]

    def found(self) -> Found:
        """Return what was found; of a run without a repetition that ended well only what its config says."""
        caveats = [
            Caveat(rule.name, self._told(rule, worst), worst.value, worst.sprung)
            for rule in TRACE_RULES
            if (worst := self._worst[rule.name]).sprung
        ]
        for of_config in SETTING_RULES:
            value = of_config.measure(self._setting)
            if value is not None and value > _threshold(of_config, self._thresholds):
                text = of_config.tell(value, self._setting)
                caveats.append(Caveat(of_config.name, text, value, self._setting.repetitions))
        return Found(caveats, rules_digest(), self._thresholds.model_dump())

    def _told(self, rule: TraceRule, worst: _Worst) -> str:
        text = rule.tell(worst.value, worst.joint, self._setting)
        return text if self._setting.repetitions == 1 else f"{text}, in {worst.sprung} of {self._seen} repetitions"


def _threshold(rule: TraceRule | SettingRule, thresholds: CaveatsConfig) -> float:
    return float(getattr(getattr(thresholds, rule.name), rule.key))
