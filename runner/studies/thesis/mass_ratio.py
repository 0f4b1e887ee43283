"""Mini/Macro mass ratios, and tip errors of Minis heavier than a given one."""

from collections.abc import Mapping

from runner.store import Run
from runner.study.measured import Measured
from runner.study.prose.patterns import found
from runner.study.run_values import measured


def ratio(run: Run) -> float:
    """Return the mass of a run's Mini over that of its Macro."""
    mini, macro = (sum(run.config["robot"]["stages"][stage]["masses"].values()) for stage in ("mini", "macro"))
    return float(mini / macro)


def ratio_of(runs: Mapping[str, Run], name: str) -> float:
    """Return the same by a run's name."""
    return ratio(runs[name])


def heavier_than(runs: Mapping[str, Run], name: str, payload: str) -> list[Measured]:
    """Return the tip error with each Mini that is heavier than that of a run."""
    return [
        measured(one.run, "max_axis_error", f"tip error, {one.levels['mass']} kg, payload {payload}")
        for one in found(runs, f"mass/{{mass}}/{payload}")
        if ratio(one.run) > ratio(runs[name])
    ]
