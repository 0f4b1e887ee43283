"""Default and tuned config on a seed that the tuning did not use: the trials were chosen by their own draws."""

import sys
from collections.abc import Sequence
from typing import cast

from runner.base.errors import ConfigError
from runner.config.compose.composer import Composer
from runner.sweeps.check import check
from runner.sweeps.plan import Item, Listed
from runner.sweeps.run import Engine, make_missing
from runner.sweeps.tuning.objective import Trial, best
from runner.sweeps.tuning.study import Fresh, Study
from runner.sweeps.writer import Rules

FEWEST = 8
"""Fewest repetitions on the fresh seed, enough to compare five metrics in pairs."""


def run_on_fresh_seed(
    study: Study, trials: Sequence[Trial], shared: Sequence[str], loader: Composer, rules: Rules, engine: Engine
) -> Fresh | None:
    """Simulate the default config and the chosen trial on another seed; return their runs, or None if neither can run.

    Args:
        study: The tuning.
        trials: Its trials.
        shared: Overrides that do not affect the simulation, such as "outputs=FOLDER".
        loader: Composer of the configs.
        rules: Rules for the execution of the runs.
        engine: Location of the execution.

    Raises:
        StoreError: if a result cannot be written, or a worker fails.
    """
    chosen = best(trials, study.objectives)
    if not chosen:
        return None
    first = min(chosen, key=lambda number: study.objectives[0].sign * trials[number].values[0])
    resolved = Listed({"default": Item(tuple(study.overrides))}, shared, loader).composed(0).resolved
    repetitions = max(FEWEST, cast(int, resolved["repetitions"]))
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
