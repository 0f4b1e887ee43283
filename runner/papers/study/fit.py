"""Compatibility check of a user-supplied controller with a study, and comparison of settings of runs."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from runner.assembly.assemble import check_assembly
from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.base.errors import ConfigError, RunnerError
from runner.config.compose.compose import compose
from runner.config.composed import Composed
from runner.controllers import CONTROLLERS
from runner.papers.study.code import UserPlugin
from runner.papers.study.estimate import Amount, counted, estimate_all, planned
from runner.papers.study.grid import Overrides
from runner.papers.study.items import Way
from runner.papers.study.study import Study
from runner.papers.study.tune import read_number
from runner.papers.study.tunings import StudyTuning, key_of, without_gains
from runner.simulation.run import simulate_repetition
from runner.simulation.tick_time import PROBED_TICKS
from runner.store import simulated_part
from runner.sweeps.differing import entries


@dataclass(frozen=True)
class Tick:
    """The first control ticks on an arm.

    Attributes:
        period: Time from one tick to the next, in s.
        computed: CPU time of one, the median, in s.
        diverged: When the arm diverged with the values of the config, in s; None where it did not.
    """

    period: float
    computed: float
    diverged: float | None


@dataclass
class LawFit:
    """Compatibility of a law with a study.

    Attributes:
        problems: Problems, each with the first run that has it and the number of others.
        ticks: The first control ticks, by robot.
        amounts: What there is to make, by robot; none where something is wrong.
        tuned: Whether there are ranges to tune it in.
    """

    tuned: bool
    ticks: dict[str, Tick] = field(default_factory=dict)
    amounts: Mapping[str, Amount] = field(default_factory=dict)
    _found: dict[str, tuple[str, int]] = field(default_factory=dict)

    @property
    def problems(self) -> list[str]:
        """Problems, a sentence each, with the first run that has it and the number of others."""
        return [
            f"{first}{f' and {count - 1} more' if count > 1 else ''}: {text}"
            for text, (first, count) in self._found.items()
        ]

    def add(self, name: str, texts: Sequence[str]) -> None:
        """Take what is wrong in a run."""
        for text in texts:
            first, count = self._found.get(text, (name, 0))
            self._found[text] = first, count + 1


def fit(study: Study, without: Study, part: UserPlugin) -> LawFit:
    """Return the compatibility of a user-supplied law with a study; nothing is stored.

    Args:
        study: The study with the controller.
        without: The same study without it.
        part: The law.
    """
    tunings = [each for each in study.untuned() if each.law == part.name]
    ranged = {each.overrides: each for each in tunings if each.ranges}
    found = LawFit(bool(ranged))
    counts = counted(study, tunings, {part.override})
    compared: dict[Overrides, tuple[str, Overrides]] = {}
    for name, own, other in study.compared():
        compared.setdefault(without_gains(own), (name, without_gains(other)))
    cells = [*dict.fromkeys([*compared, *counts])]
    plan = planned(cells, Way(Path("outputs"), config_dirs=study.config_dirs))
    seen: set[str] = set()
    begun: set[str] = set()
    ended: set[str] = set()
    for cell, own in enumerate(cells):
        name, other = compared.get(own, (shlex.join(own), ()))
        try:
            composed = plan.composed(cell)
            robot, config = composed.choices["robot"], _validated(composed, part)
            if other and not seen.issuperset(own):  # an override is compared where it comes for the first time
                seen |= {*own}
                found.add(name, _unlike((part.name, composed), compose(other, without.config_dirs)))
            if robot not in begun:
                begun.add(robot)
                found.ticks[robot] = _first_ticks(config)
            if own in ranged and robot not in ended:
                ended.add(robot)
                _check_ends(ranged[own], composed, part, found)
        except ConfigError as error:
            found.add(name, error.problems)
    if not found.problems:
        found.amounts = estimate_all(plan, [counts.get(own, (0, 0, 0)) for own in cells])
    return found


def _validated(composed: Composed, part: UserPlugin) -> RunConfig:
    """Return a checked config.

    Raises:
        ConfigError: with every problem, or if the law in it is not the user's.
    """
    law = composed.resolved["controller"]
    kind = law.get("kind") if isinstance(law, Mapping) else law
    if kind != part.name or not CONTROLLERS.is_user_supplied(part.name):
        must = f"must be '{part.name}', as the file is called, and that no name of a law of ours"
        raise ConfigError(f"controller.kind: {must}; found '{kind}'")
    return validate(composed)


def _unlike(own: tuple[str, Composed], other: Composed) -> list[str]:
    """Return the first setting in which a law differs from another one, other than the law itself."""
    (name, composed), settings = own, setting(other.resolved)
    text = difference((name, setting(composed.resolved)), (other.choices["controller"], settings))
    return [text] if text else []


def _first_ticks(config: RunConfig) -> Tick:
    """Return the period and computing time of the first control ticks, and any divergence.

    Raises:
        ConfigError: if the law raises, or gives no finite torques of the right shape.
    """
    trace = simulate_repetition(config, ticks=PROBED_TICKS)
    failure = trace.failure
    if failure is not None and not failure.reason.startswith("diverged"):
        raise ConfigError(f"at {failure.time:g} s: {failure.reason}")
    return Tick(config.timing.tick, float(np.median(trace.tick_seconds)), None if failure is None else failure.time)


def _check_ends(tuning: StudyTuning, composed: Composed, part: UserPlugin, found: LawFit) -> None:
    """Note what is wrong with a law at both ends of each of its ranges."""
    for name, factors in tuning.ranges.items():
        try:
            key = key_of(name, read_number(tuning, name, composed.resolved), factors)
        except ConfigError as error:
            found.add(tuning.name, error.problems)
            continue
        except RunnerError as error:
            found.add(tuning.name, [str(error).removeprefix(f"tuning {tuning.name}: ")])
            continue
        for value in (key.low, key.high):
            text = key.override(value)
            try:
                end = compose((*tuning.overrides, text), composed.config_dirs)
                check_assembly(_validated(end, part))
                found.add(tuning.name, _unlike((f"{part.name} with {text}", end), composed))
            except ConfigError as error:
                found.add(f"{tuning.name} with {text}", error.problems)


_LAW = ("controller", "disturbance_observer")


def setting(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of a run without its law and disturbance observer, but with the period of the law.

    Args:
        config: The resolved config of the run.
    """
    part = simulated_part(config)
    period = {"controller.period": part["controller"].get("period")}
    return {key: value for key, value in part.items() if key not in _LAW} | period


def difference(one: tuple[str, Mapping[str, Any]], other: tuple[str, Mapping[str, Any]]) -> str:
    """Return in which key the settings of two laws differ, each given with the law's name; empty where in none."""
    if one[1] == other[1]:
        return ""
    (law, ours), (their_law, theirs) = ((name, dict(entries(own))) for name, own in (one, other))
    key = next((key for key in dict.fromkeys([*ours, *theirs]) if ours.get(key) != theirs.get(key)), None)
    if key is None:
        return ""
    return (
        f"{key} is {ours.get(key, 'none')} for {law} and {theirs.get(key, 'none')} for {their_law}; laws are compared "
        "where nothing but they and their gains differ"
    )
