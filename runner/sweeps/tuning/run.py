"""Execution of a whole tuning, from its command line to its stored trials."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
from hydra.core.override_parser.overrides_parser import OverridesParser

from runner import store
from runner.base.dotted_keys import get
from runner.base.errors import ConfigError, RunnerError, TemporaryError
from runner.base.limits import TRIALS
from runner.config.compose.composer import Composer
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.files import groups
from runner.config.compose.overrides import prepare
from runner.store.axes import is_simulated
from runner.store.kinds import note
from runner.store.names import Names
from runner.sweeps.at_work import at_work
from runner.sweeps.check import Checked, check
from runner.sweeps.plan import Grid, Item, Listed, Plan
from runner.sweeps.run import Engine, clean, make_jobs, make_missing, make_rules
from runner.sweeps.tuning.journal import Journal
from runner.sweeps.tuning.key import RANGES, TunedKey, read_key
from runner.sweeps.tuning.objective import Objective, Trial, best
from runner.sweeps.tuning.queue import TrialQueue
from runner.sweeps.tuning.study import JOURNAL, Fresh, Tuning, TuningDefinition
from runner.sweeps.typed import axis_names
from runner.sweeps.writer import Rules

_FEWEST = 8  # repetitions on the fresh seed, enough to compare five metrics in pairs


def tune(
    overrides: Sequence[str],
    objectives: Sequence[Objective],
    trials: int,
    at_once: int,
    command: str,
    config_dirs: Sequence[Path] = (),
) -> Tuning:
    """Execute the missing trials of a tuning.

    Args:
        overrides: Overrides, such as "robot=macro" and "controller.natural_frequency=interval(5,50)".
        objectives: The objectives.
        trials: Number of trials after which to end, including those of earlier commands.
        at_once: Number of simultaneous trials; the choice of trials depends on it.
        command: The command that starts and continues the tuning, stored with it.
        config_dirs: User config folders.

    Raises:
        ConfigError: if a key cannot be tuned, or a config in its range cannot be run; no trial has been started.
        RunnerError: if there are too many trials, a run lacks a metric, another command works on the tuning, or the
            Dask scheduler does not answer.
        TemporaryError: if a result cannot be written, or a worker fails.
    """
    if excess := TRIALS.excess(trials):
        raise RunnerError(f"the tuning {excess}; take fewer")
    fixed, keys = _read(overrides, config_dirs)
    loader = Composer(config_dirs)
    sweeper = loader.sweeper(fixed)
    if names := axis_names(sweeper.params):
        raise ConfigError(
            f"hydra.sweeper.params: brings axes ({names}), which a tuning does not sweep over. "
            "Allowed: null, as hydra.sweeper.params=null, or an experiment without axes"
        )
    engine = Engine(sweeper.workers, sweeper.address)
    shared = [text for text in fixed if not text.startswith("hydra.")]
    _check_numbers(Grid(shared, loader), keys)
    plan, checked = _check_ranges(loader, shared, keys)
    shown = [text for text in shared if is_simulated(text)]
    if checked.first.sweep.part is not None:
        raise ConfigError("sweep.part: a tuning has no parts, because its trials follow from each other; leave it out")
    study = TuningDefinition(shown, keys, objectives, at_once, command)
    seed = cast(int, plan.composed(0).resolved["seed"])
    store.prepare(checked.outputs)
    folder = study.folder(checked.outputs, checked.names)
    with at_work(folder, exclusive=True) as name:
        rules = replace(make_rules(checked.first.sweep, folder, trials, name), trace="all")
        journal = Journal(folder / JOURNAL, keys, objectives)
        study.write(folder, journal.trials)
        note(folder)
        queue = TrialQueue(study, journal, loader, rules, trials, seed)
        try:
            _work_off(plan, checked, queue, engine, len(journal.trials))
        finally:
            study.write(folder, journal.trials)
        clean(rules, [trial.run for trial in journal.trials if trial.run])
        unsimulated = [text for text in shared if not is_simulated(text)]
        fresh = _run_on_fresh_seed(study, journal.trials, unsimulated, loader, rules, engine)
        study.write(folder, journal.trials, fresh)
    return Tuning(folder, study, journal.trials, fresh)


def _work_off(plan: Plan, checked: Checked, queue: TrialQueue, engine: Engine, ended: int) -> None:
    """Execute all trials of a queue; start workers again if the last trials crashed theirs."""
    while queue.left:
        for report in make_jobs(plan, checked, queue, np.zeros(queue.left, dtype=np.intp), engine, ended):
            if report.trouble:
                raise TemporaryError(f"{report.trouble}; finished trials are stored; the same command continues")
            queue.note(report.outcomes)
            if queue.rules.stop_at_failure and any(end.failure for end in report.outcomes):
                return


def _run_on_fresh_seed(
    study: TuningDefinition,
    trials: Sequence[Trial],
    shared: Sequence[str],
    loader: Composer,
    rules: Rules,
    engine: Engine,
) -> Fresh | None:
    """Simulate the default config and the chosen trial on another seed; return their runs, or None if neither can run.

    The trials were chosen by their own draws. `shared` are overrides that do not affect the simulation.
    """
    chosen = best(trials, study.objectives)
    if not chosen:
        return None
    first = min(chosen, key=lambda number: study.objectives[0].sign * trials[number].values[0])
    resolved = Listed({"default": Item(tuple(study.overrides))}, shared, loader).composed(0).resolved
    repetitions = max(_FEWEST, cast(int, resolved["repetitions"]))
    fresh = [f"seed={cast(int, resolved['seed']) + 1}", f"repetitions={repetitions}"]

    def item(overrides: Sequence[str]) -> Item:
        return Item((*(text for text in overrides if not text.startswith(("seed=", "repetitions="))), *fresh))

    cells = {"default": item(study.overrides), "tuned": item(study.trial_overrides(trials[first]))}
    plan = Listed(cells, shared, loader)
    try:
        checked = check(plan)
        make_missing(plan, checked, rules, engine)
    except ConfigError as error:
        print(f"runner: default and tuned config are not compared on {fresh[0]}: {error}", file=sys.stderr)
        return None
    return Fresh(first, *checked.names)


def _read(overrides: Sequence[str], config_dirs: Sequence[Path]) -> tuple[list[str], list[TunedKey]]:
    """Return the overrides that all trials share, as typed, and the keys to tune."""
    try:
        parsed = OverridesParser.create().parse_overrides(prepare(overrides))
    except COMPOSITION_ERRORS as error:
        raise explain(error) from None
    fixed: list[str] = []
    keys: dict[str, TunedKey] = {}
    problems: list[str] = []
    for text, override in zip(overrides, parsed, strict=True):
        try:
            key = read_key(override)
            if key is not None and key.name in groups(config_dirs):
                raise ConfigError(f"{key.name}: is a group of options, not a number")
            if key is not None and not is_simulated(key.name):
                raise ConfigError(f"{key.name}: says how runs are made, not what is simulated; it cannot be tuned")
        except ConfigError as error:
            problems += error.problems
            continue
        if key is None:
            fixed.append(text)
        else:
            keys[key.name] = key
    if problems:
        raise ConfigError(problems)
    if not keys:
        raise ConfigError(f"nothing to tune; give a key a range, as in KEY={RANGES}")
    return fixed, list(keys.values())


def _check_numbers(plan: Plan, keys: Sequence[TunedKey]) -> None:
    """Check that keys have a number or null as their value; a later check rejects unknown keys and proposes names."""
    resolved = plan.composed(0).resolved
    problems = []
    for key in keys:
        found = get(resolved, key.name)
        if isinstance(found, dict):
            problems.append(f"{key.name}: is a group of keys ({', '.join(map(str, found))}); tune one of them")
        elif isinstance(found, bool | str | list):
            problems.append(f"{key.name}: is not a number; found {found!r}")
    if problems:
        raise ConfigError(problems)


def _check_ranges(loader: Composer, shared: Sequence[str], keys: Sequence[TunedKey]) -> tuple[Plan, Checked]:
    """Check the configs at both ends of the ranges and between; return the last plan and the result of its check."""
    problems: dict[str, None] = {}
    names: list[str] = []
    for values in zip(*(key.probes for key in keys), strict=True):
        plan = Grid([*shared, *(key.override(value) for key, value in zip(keys, values, strict=True))], loader)
        try:
            checked = check(plan)
            names += checked.names
        except ConfigError as error:
            problems |= dict.fromkeys(error.problems)
    if problems:
        raise ConfigError(problems, "  nothing was started")
    if checked.first.sweep.trace not in ("auto", "all"):
        raise ConfigError(f"sweep.trace: a tuning keeps the trace of every run; found '{checked.first.sweep.trace}'")
    return plan, replace(checked, names=Names.of(names))
