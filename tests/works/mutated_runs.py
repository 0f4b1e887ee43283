"""Runs with changed values, to see which sentences of a report they refute."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from runner.reporting.findings import Finding
from runner.store import Run

CHANGES = (1000.0, 1e-3, None)
"""By how much a run's values are changed; None takes them away."""


class Watched(dict[str, Run]):
    """Runs that remember which of them were asked for."""

    def __init__(self, runs: Mapping[str, Run]) -> None:
        super().__init__(runs)
        self.read: dict[str, None] = {}

    def __getitem__(self, name: str) -> Run:
        self.read[name] = None
        return super().__getitem__(name)


def changed(run: Run, factor: float | None) -> Run:
    """Return a run whose metrics, signals and time of failure are so many times as large, or have no value."""
    metrics = {name: _scaled(metric, factor) for name, metric in run.metrics.items()}
    ended: dict[str, object] = {"status": "ok", "failure": None}
    if factor is not None and run.failure is not None:
        ended = {"status": run.status, "failure": {**run.failure, "time": factor * run.failure["time"]}}
    mutant = replace(run, record={**run.record, **ended, "metrics": metrics})
    signals = run.trace.drop(columns="t") * (np.nan if factor is None else factor)
    mutant.__dict__["trace"] = pd.concat([run.trace[["t"]], signals], axis=1)
    return mutant


def _scaled(metric: Mapping[str, object], factor: float | None) -> dict[str, object]:
    kept = dict(metric)
    for key in ("median", "min", "max"):
        value = kept[key]
        kept[key] = None if factor is None or not isinstance(value, float | int) else factor * value
    return kept


def mutants(build: Callable[[Mapping[str, Run]], Finding], runs: Mapping[str, Run]) -> Iterator[Finding]:
    """Yield a finding as it is, with all of the runs that it reads changed, and with each of them changed in turn."""
    watched = Watched(runs)
    yield build(watched)
    for factor in CHANGES:
        yield build({**runs, **{name: changed(runs[name], factor) for name in watched.read}})
        for name in watched.read:
            yield build({**runs, name: changed(runs[name], factor)})


def never_failing(found: list[Finding]) -> list[str]:
    """Return the conditions, by their text unchanged, that hold whatever was changed."""
    return [
        condition.text
        for index, condition in enumerate(found[0].conditions)
        if all(len(each.conditions) > index and each.conditions[index].holds for each in found)
    ]
