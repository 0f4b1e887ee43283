"""Longest stable sample time of each stage of the combined arm: measured growth and closed form."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.reporting.document import Block, Table, Text
from runner.reporting.figures import origin
from runner.store import Run
from runner.study.measured import Condition, Measured
from runner.study.prose.patterns import found
from runner.study.run_values import failures

_FLOOR, _CEILING = 1e-13, 1e-2  # m, within which a decay or growth is exponential
_STEP = 1e-3  # m, the goal step
_STILL = 1e-9  # m per period: what is left of a decay
_DYNAMICS = ("coupled", "decoupled")


@dataclass(frozen=True)
class _Case:
    """One stage's period varied on one plant: its grid, stage, and Euler steps in a period, None on Runge-Kutta."""

    grid: str
    stage: str
    steps: int | None = None

    @property
    def plant(self) -> str:
        if self.steps is None:
            return "Runge-Kutta"
        return f"Euler, {self.steps} step{'s' if self.steps > 1 else ''} per period"

    def limit(self, run: Run) -> float:
        """Return the largest stable period for xi = 1, in s: omega_n times it is the root of 4 - 4 w - w^2 / n."""
        root = 1.0 if self.steps is None else float(2.0 * (np.sqrt(self.steps**2 + self.steps) - self.steps))
        return root / float(run.config["controller"]["natural_frequency"][self.stage])


_CASES = (_Case("macro", "macro"), _Case("mini", "mini"), _Case("euler1", "mini", 1), _Case("euler4", "mini", 4))

Bracket = tuple[Measured, Measured, Measured]
"""The closed form, the last period before the first one that grows, and that one, in ms."""


def brackets(runs: Mapping[str, Run]) -> list[Bracket]:
    """Return the bracket of each case on both plants."""
    return [_bracket(runs, case, dynamics) for case in _CASES for dynamics in _DYNAMICS]


def bracketed(found: Sequence[Bracket]) -> list[Condition]:
    """Return the conditions that the last period that decays lies below the closed form, the first that grows above."""
    return [condition for closed, last, first in found for condition in (last <= closed, first >= closed)]


def limits(runs: Mapping[str, Run], caption: str, found: Sequence[Bracket]) -> Table:
    """Return the closed form of each case beside what the simulation gives on both plants."""
    rows = [
        [case.stage, case.plant, number(coupled[0].value), _range(*coupled[1:]), _range(*decoupled[1:])]
        for case, coupled, decoupled in zip(_CASES, found[::2], found[1::2], strict=True)
    ]
    header = ["stage varied", "plant", "closed form", *_DYNAMICS]
    return Table(caption, header, rows, (2,), origin(runs["stage_sampling/macro/coupled/0.01"]))


def margin(runs: Mapping[str, Run], name: str, stage: str) -> float:
    """Return how many times longer than a run's period of a stage the longest stable one is under exact integration."""
    return _Case(stage, stage).limit(runs[name]) / float(runs[name].config["controller"]["period"][stage])


def growth_law(rate: float) -> Callable[[float], float]:
    """Return the growth per period under exact integration for xi = 1, a rate in rad/s and a period in ms."""

    def largest(period: float) -> float:
        w = 1e-3 * rate * period
        transition = np.array([[1.0 - w**2 / 2.0, 1.0 - w], [-(w**2), 1.0 - 2.0 * w]])
        return float(np.abs(np.linalg.eigvals(transition)).max())

    return largest


def predicted_growth(run: Run) -> float:
    """Return that of a run's Macro."""
    controller = run.config["controller"]
    return growth_law(controller["natural_frequency"]["macro"])(1e3 * controller["period"]["macro"])


def growth(run: Run) -> float:
    """Return the measured growth of the Macro's deviation per period, NaN where the trace is too short for it."""
    changes = _changes(run, "macro")
    index = np.arange(len(changes))
    good = (index >= 4) & (changes > _FLOOR) & (changes < _CEILING)
    if good.sum() < 6:
        return float("nan")
    last = index[good][len(index[good]) // 2 :]
    return float(np.exp(np.polyfit(last, np.log(changes[last]), 1)[0]))


def beyond_the_limit(runs: Mapping[str, Run]) -> list[Block]:
    """Return a sentence on the runs that diverge above the limit, and a notice where one fails below it."""
    ours = {name: run for name, run in runs.items() if name.startswith("stage_sampling/")}
    below, count = {}, 0
    for name, run in ours.items():
        _, grid, _, period = name.split("/")
        case = next(case for case in _CASES if case.grid == grid)
        if run.status == "failed" and float(period) < case.limit(run):
            below[name] = run
        count += run.status == "failed"
    text = f"{count - len(below)} of the {len(ours)} runs lie above the limit and end as diverged."
    return [Text(text), *failures(below)]


def _bracket(runs: Mapping[str, Run], case: _Case, dynamics: str) -> Bracket:
    tried = found(runs, f"stage_sampling/{case.grid}/{dynamics}/{{period}}")
    periods = [1e3 * float(one.levels["period"]) for one in tried]
    grown = next((place for place, one in enumerate(tried) if _grows(one.run, case.stage)), len(tried))
    last, first = (periods[place] if 0 <= place < len(tried) else None for place in (grown - 1, grown))
    words = f"{case.stage}, {case.plant}, {dynamics}"
    return (
        Measured(f"closed form ({words})", 1e3 * case.limit(tried[0].run), "ms"),
        Measured(f"last period that decays ({words})", last, "ms"),
        Measured(f"first period that grows ({words})", first, "ms"),
    )


def _range(last: Measured, first: Measured) -> str:
    if first.value is None:
        return "no growth" if last.value is None else f"above {number(last.value)}"
    return f"below {number(first.value)}" if last.value is None else f"{number(last.value)} to {number(first.value)}"


def _changes(run: Run, stage: str) -> FloatArray:
    """Return how far the stage's end point moves in each of its periods, in m: it has no rest value to subtract."""
    t = run.t
    period = float(run.config["controller"]["period"][stage])
    every = max(1, round(period / float(np.diff(t).min()))) if len(t) > 1 else 1
    error = run.vector("macro_error" if stage == "macro" else "error")[::every]
    return np.asarray(np.linalg.norm(np.diff(error, axis=0), axis=1))


def _grows(run: Run, stage: str) -> bool:
    changes = _changes(run, stage)
    if run.status == "failed" or len(changes) < 8:
        return run.status == "failed"
    quarter = len(changes) // 4
    late, early = changes[-quarter:].max(), changes[quarter : 2 * quarter].max()
    return bool(late > _STILL and (late > early or late > _STEP))
