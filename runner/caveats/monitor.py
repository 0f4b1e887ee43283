"""Evaluation of the caveat rules in every repetition, with the worst value of each rule."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate
from operator import attrgetter

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.memory import Memory
from runner.caveats import plant_error, rounding
from runner.caveats.integration_error import PlantError
from runner.caveats.plant_error import PlantStep
from runner.caveats.rounding_growth import RoundingGrowth
from runner.caveats.rule import Caveat, Found, TraceRule
from runner.caveats.setting import RunSetting, RunSignals
from runner.caveats.setting_rules import SETTING_RULES
from runner.caveats.trace_rules import TRACE_RULES
from runner.caveats.versions import rules_digest
from runner.config.judgement import THRESHOLDS, CaveatsConfig
from runner.schema.bound import Range

_KEYS = {rule: key for rule, (key, *_) in THRESHOLDS.items()}
_values = attrgetter(*(f"{rule}.{key}" for rule, key in _KEYS.items()))

_MEMORY = Memory(64)  # runs of a sweep share their setting
_BLOCK = 64  # runs in one block, which fits in the CPU cache


@dataclass
class _Worst:
    """Largest value of a rule so far, with its joint and the number of repetitions that triggered the rule."""

    value: float = -np.inf
    joint: int = 0
    sprung: int = 0


class Watch:
    """Evaluation of the caveat rules over the repetitions of a run.

    Args:
        setting: Setting of the run.
        thresholds: Thresholds of the rules.
    """

    def __init__(self, setting: RunSetting, thresholds: CaveatsConfig) -> None:
        self._setting = setting
        self._thresholds, self._limits = _by_rule(_values(thresholds))
        self._worst: dict[str, _Worst] = {}
        self._seen = 0

    def look(self, signals: RunSignals) -> None:
        """Evaluate the rules on one repetition, or on several on a leading axis."""
        look_together([self], signals)

    def join(self, later: "Watch") -> None:
        """Merge the watch of later repetitions of the same run."""
        self._seen += later._seen
        for name, theirs in later._worst.items():
            worst = self._worst.setdefault(name, _Worst())
            worst.sprung += theirs.sprung
            if theirs.value > worst.value:
                worst.value, worst.joint = theirs.value, theirs.joint

    def found(
        self, error: PlantError | None = None, step: PlantStep | None = None, growth: RoundingGrowth | None = None
    ) -> Found:
        """Return the caveats; if no repetition succeeded, only those on the config.

        Args:
            error: Integration error of the plant, if it was measured.
            step: Integration step of the plant.
            growth: Growth of rounding errors, if it was measured.
        """
        caveats = [
            Caveat(rule.name, self._told(rule, worst), worst.value)
            for rule in TRACE_RULES
            if (worst := self._worst.get(rule.name))
        ]
        caveats += _MEMORY.recall(_of_setting, self._setting, self._thresholds)
        if error is not None and step is not None:
            caveats += filter(None, [plant_error.caveat_of(error, step, self._threshold(plant_error.NAME))])
        if growth is not None:
            caveats += filter(None, [rounding.caveat_of(growth, self._threshold(rounding.NAME))])
        return Found(caveats, rules_digest(), self._thresholds)

    def _threshold(self, rule: str) -> float:
        return self._thresholds[rule][_KEYS[rule]]

    def _note(self, rule: TraceRule, values: FloatArray, sprung: int) -> None:
        """Record the values of a rule, shape (repetitions, n), and the number of repetitions that triggered it."""
        worst = self._worst.setdefault(rule.name, _Worst())
        worst.sprung += sprung
        largest = int(values.argmax())
        value = float(values.flat[largest])
        if value > worst.value:
            worst.value, worst.joint = value, largest % values.shape[-1]

    def _told(self, rule: TraceRule, worst: _Worst) -> str:
        text = rule.tell(worst.value, worst.joint, self._setting)
        return text if self._setting.repetitions == 1 else f"{text}, in {worst.sprung} of {self._seen} repetitions"


def _of_setting(setting: RunSetting, thresholds: Mapping[str, Mapping[str, float]]) -> list[Caveat]:
    caveats = []
    for rule in SETTING_RULES:
        value = rule.measure(setting)
        if value is not None and Range(high=thresholds[rule.name][_KEYS[rule.name]]).exceeded(value):
            caveats.append(Caveat(rule.name, rule.tell(value, setting), value))
    return caveats


def look_together(watches: Sequence[Watch], signals: RunSignals) -> None:
    """Evaluate the rules on several runs together, each with a separate watch.

    Args:
        watches: The watch of each run. Plant, commands, periods, kind of path, environment and settling band must be
            the same for all runs; other numbers of the config may differ.
        signals: Signals of all runs on the first axis, or of one run; repetitions may be on the next axis.
    """
    if len(watches) == 1 and signals.q.ndim == 3 and len(signals.q) > _BLOCK:
        for first in range(0, len(signals.q), _BLOCK):
            look_together(watches, signals.part(first, first + _BLOCK))
        return
    if len(watches) > _BLOCK:
        for first in range(0, len(watches), _BLOCK):
            last = first + _BLOCK
            look_together(watches[first:last], signals.part(first, last))
        return
    measured = [rule.measure(signals, watches[0]._setting) for rule in TRACE_RULES]
    firsts = [0, *accumulate(values.shape[-1] for values in measured[:-1])]
    worst = np.maximum.reduceat(np.concatenate(measured, axis=-1), firsts, axis=-1)
    worst = worst.reshape(len(watches), -1, len(TRACE_RULES))
    limits = np.array([watch._limits for watch in watches])
    sprung = Range(high=limits[:, None]).exceeded(worst).sum(axis=1)
    for watch in watches:
        watch._seen += worst.shape[1]
    for run, number in zip(*sprung.nonzero(), strict=True):
        values = measured[number].reshape(*worst.shape[:2], -1)[run]
        watches[run]._note(TRACE_RULES[number], values, int(sprung[run, number]))


@lru_cache(maxsize=8)  # the runs of a sweep share their thresholds
def _by_rule(values: tuple[float, ...]) -> tuple[Mapping[str, Mapping[str, float]], Sequence[float]]:
    """Return the thresholds by rule and key, as stored, and those of the trace rules in their order."""
    thresholds = {name: {key: value} for (name, key), value in zip(_KEYS.items(), values, strict=True)}
    return thresholds, [thresholds[rule.name][_KEYS[rule.name]] for rule in TRACE_RULES]
