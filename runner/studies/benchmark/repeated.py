"""Tracking error in the last period of a repeated motion, compared with iterative learning."""

from collections.abc import Mapping

import numpy as np

from runner.base.quantities import quantity
from runner.reporting.document import Table
from runner.reporting.figures import origin
from runner.reporting.words import in_words
from runner.store import Run
from runner.studies.benchmark.made import ARMS, CONDITIONS
from runner.study.measured import Measured
from runner.study.prose.patterns import found

_METRIC = "rms_tracking_error_last_period"


def last_periods(runs: Mapping[str, Run], caption: str) -> Table:
    """Return the error of each law in the last period, by arm and condition."""
    every = found(runs, "repeated/{arm}/{law}/{condition}")
    columns = dict.fromkeys((one.levels["arm"], one.levels["condition"]) for one in every)
    rows: dict[str, list[str]] = {}
    for one in every:
        error = _error(one.run)
        told = quantity(error, "m") if np.isfinite(error) else "failed"
        rows.setdefault(one.levels["law"], []).append(told)
    header = ["law", *(f"{ARMS[arm]}, {CONDITIONS[condition]}" for arm, condition in columns)]
    told_rows = [[in_words(law), *own] for law, own in rows.items()]
    return Table(caption, header, told_rows, range(1, len(header)), origin(every[0].run))


def over_learning(runs: Mapping[str, Run], condition: str, law: str, *arms: str) -> list[Measured]:
    """Return the error of a law in the last period over that of iterative learning, on some arms, or on each."""
    told = []
    arm = f"{{arm={'|'.join(arms)}}}" if arms else "{arm}"
    for one in found(runs, f"repeated/{arm}/{law}/{condition}"):
        learned = _error(runs[f"repeated/{one.levels['arm']}/iterative_learning/{condition}"])
        error = _error(one.run)
        value = error / learned if np.isfinite(learned) else None
        words = f"{in_words(law)} over iterative learning, {ARMS[one.levels['arm']]}, {CONDITIONS[condition]}"
        told.append(Measured(f"error of {words}", value))
    return told


def _error(run: Run) -> float:
    median = run.metrics[_METRIC]["median"] if _METRIC in run.metrics else None
    return np.inf if median is None or run.status != "ok" else float(median)
