"""Signals of any repetition of a stored run; every repetition except the first is simulated again."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from runner import store
from runner.base.errors import ConfigError, RunnerError
from runner.store.run import units_of

if TYPE_CHECKING:
    import pandas as pd

    from runner.base.trace import Trace
    from runner.config.run import RunConfig


@dataclass(frozen=True)
class Signals:
    """The signals of one repetition.

    Attributes:
        frame: One row per tick, one column per signal.
        units: Unit of each column.
    """

    frame: "pd.DataFrame"
    units: Mapping[str, str]


def signals_of(run: store.Run, repetition: int) -> Signals:
    """Return the signals of a repetition: the first is read from the store, any other is simulated again.

    The metrics of the new simulation must equal the stored metrics, to the last bit.

    Raises:
        RunnerError: if there is no such repetition, or the code, the robot's file or the machine gives another result.
        DamagedError: if the run is damaged.
    """
    count = run.repetitions
    if not 0 <= repetition < count:
        raise RunnerError(f"repetition: run {run.hash} has no repetition {repetition}. Allowed: 0 to {count - 1}.")
    if repetition == 0 and run.text is None:
        return Signals(store.Run.trace(run).copy(), run.units)
    return _simulated(run, repetition)


def _simulated(run: store.Run, repetition: int) -> Signals:
    from runner.metrics import evaluate
    from runner.simulation.assembly import metric_context
    from runner.store.writing import trace_table

    config = _checked(run, repetition)
    trace = _simulate(config, repetition)
    found = evaluate(trace, metric_context(config), [])
    for name in run.metrics:
        stored = float(run.values(name)[repetition])
        value = None if math.isnan(stored) else stored
        if found.get(name) != value:
            raise RunnerError(
                f"repetition {repetition} of {run.hash}, simulated again, differs: {name} is {found.get(name)}, "
                f"stored is {value}; another machine or library version rounds in another way"
            )
    table = trace_table(trace)
    return Signals(table.to_pandas(), units_of(table))


def _checked(run: store.Run, repetition: int) -> "RunConfig":
    """Return the config of a run; raise an error if the code or the robot has changed since the run."""
    from runner.config.validation import validate

    cannot = f"repetition {repetition} of {run.hash} cannot be simulated again: "
    if store.run_hash(run.config, run.urdf) != run.hash:
        raise RunnerError(
            f"{cannot}the code has changed since the run (the runner, a plug-in, or the version of an engine), or one "
            "of its plug-ins is not loaded; simulate it again with runner.run"
        )
    try:
        config = validate(run.composed)
    except ConfigError as error:
        raise RunnerError(f"{cannot}{'; '.join(error.problems)}") from None
    if config.arm.urdf != run.urdf:
        raise RunnerError(f"{cannot}the file of its robot has changed since the run; simulate it again with runner.run")
    return config


def _simulate(config: "RunConfig", repetition: int) -> "Trace":
    from runner.simulation.assembly import assemble
    from runner.simulation.run import simulate_repetition

    loop = assemble(config, repetition)
    try:
        return simulate_repetition(loop, config, repetition)[0]
    finally:
        loop.close()
