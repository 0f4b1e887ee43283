"""Figure, tables and numbers of the precision study."""

from collections.abc import Callable, Mapping

import numpy as np

from runner.base.quantities import number, quantity
from runner.papers.studies.precision.tried import (
    COMPILED,
    PLANTS,
    SteppedPlant,
    allowed_error,
    by_steps,
    knee,
    order,
    solutions,
)
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs
from runner.reporting.document import Curves, Panel, Series
from runner.reporting.figures import origin

_ARMS = {"macro": "Macro", "combined": "Mini on Macro", "xarm7": "xArm7"}
_CASES = {"free": "free", "control": "under control"}
_PAIRS = [(case, arm) for arm in _ARMS for case in _CASES]
_LABELLED = {"PyBullet": -1, "MuJoCo": 0, COMPILED: 0}  # places of the steps named in the figure
_NONE = {"knee": "beyond", "step": "none"}
_ROOM = (0.1, 100.0)  # around the errors, for labels above a line


def plants(first: int, last: int) -> tuple[str, ...]:
    """Return some plants: 0 to 2 are those by Euler's scheme, 2 to 4 is Runge-Kutta, compiled and by Pinocchio."""
    return PLANTS[first:last]


def accuracy(runs: Runs, caption: str) -> Curves:
    """Return the tip's error over the computing time, a panel for each arm and case, a line for each plant."""
    panels = []
    for case, arm in _PAIRS:
        series: list[Series] = []
        for color, plant in enumerate(PLANTS):
            tried = by_steps(runs, case, arm, plant)
            x, y = (np.array([getattr(each, name) for each in tried]) for name in ("seconds", "tip"))
            steps = [quantity(each.step, "s") for each in tried]
            hints = [f"step {step}" for step in steps]
            series.append(Series(plant, x, y, "points_line", color=color, hints=hints))
            if plant in _LABELLED:
                at = [_LABELLED[plant]]
                series.append(Series("", x[at], y[at], "points", color=color, label=steps[at[0]]))
        y = np.concatenate([each.y for each in series])
        known = y[y > 0.0]
        ends = (_ROOM[0] * float(known.min()), _ROOM[1] * float(known.max())) if known.size else None
        title = f"{_ARMS[arm]}, {_CASES[case]}"
        panels.append(Panel(title, "computing time (s)", "tip error (m)", series, True, True, y_range=ends))
    return Curves(caption, panels, 2, origin(next(iter(runs.values()))))


def solution_rows(runs: Runs) -> list[list[str]]:
    """Return arm, case, distance of another method and of a coarser tolerance, in rad, and change of energy."""
    kept = {(case, arm): solutions(runs)[f"{case}/{arm}"] for case, arm in _PAIRS}
    found = {
        pair: (own["apart"]["collocation"], own["apart"]["tolerance"], own["energy"]) for pair, own in kept.items()
    }
    return [[_ARMS[arm], _CASES[case], *(number(each, 2) for each in own)] for (case, arm), own in found.items()]


def rows(runs: Runs, what: str, *plants: str, allowed: bool = False) -> list[list[str]]:
    """Return arm, case, with `allowed` the tip's error that is small enough, and of each plant a cell.

    It is the `order`; the joint `errors` by the largest and the smallest step, in rad; the `knee` with the joint error
    left there; or the largest `step` whose error is small enough with its computing time.
    """
    found = []
    for case, arm in _PAIRS:
        most = allowed_error(runs, case, arm)
        cells = [_CELLS[what](by_steps(runs, case, arm, plant), most) for plant in plants]
        found.append([_ARMS[arm], _CASES[case], *([quantity(most, "m")] if allowed else []), *cells])
    return found


def of_solutions(runs: Runs, words: str, key: str, way: str = "", unit: str = "1") -> list[Measured]:
    """Return a number of the solution of each case and arm that has it, such as its distance from another way to it."""
    known = {name: own[key][way] if way else own[key] for name, own in solutions(runs).items()}
    return [Measured(f"{words}: {name}", float(own), unit) for name, own in known.items() if own is not None]


def of_plants(runs: Runs, words: str, what: str, unit: str, *plants: str) -> list[Measured]:
    """Return a number of some plants on each arm and case.

    It is the `order`; the joint error `left` by the smallest step, in rad; or the tip's error by the `largest step`,
    over the error allowed.
    """
    return [
        Measured(
            f"{words}: {plant}, {_ARMS[arm]}, {_CASES[case]}",
            _NUMBERS[what](by_steps(runs, case, arm, plant), allowed_error(runs, case, arm)),
            unit,
        )
        for plant in plants
        for case, arm in _PAIRS
    ]


def compiled_apart(runs: Runs, words: str) -> list[Measured]:
    """Return the largest difference between the errors of Runge-Kutta, compiled and by Pinocchio, in rad."""

    def apart(case: str, arm: str) -> float:
        both = (by_steps(runs, case, arm, plant) for plant in PLANTS[2:])
        return max(abs(float(one.joints - other.joints)) for one, other in zip(*both, strict=True))

    return [Measured(f"{words}: {_ARMS[arm]}, {_CASES[case]}", apart(case, arm), "rad") for case, arm in _PAIRS]


def without(runs: Runs, words: str, what: str, *plants: str) -> Measured:
    """Return the number of arms and cases in which some plants have no `knee`, or no `step` that is small enough."""
    return Measured(words, sum(row.count(_NONE[what]) for row in rows(runs, what, *plants)))


def large_enough(tried: list[SteppedPlant], allowed: float) -> SteppedPlant | None:
    """Return the largest step with a tip error, in m, below what is allowed; None if there is none."""
    return next((each for each in tried if each.tip < allowed), None)


def _at_knee(tried: list[SteppedPlant], _: float) -> str:
    at = knee(tried)
    return _NONE["knee"] if at is None else f"{quantity(at.step, 's')}: {number(at.joints, 2)}"


def _at_step(tried: list[SteppedPlant], allowed: float) -> str:
    at = large_enough(tried, allowed)
    return _NONE["step"] if at is None else f"{quantity(at.step, 's')}: {quantity(at.seconds, 's', 2)}"


_CELLS: Mapping[str, Callable[[list[SteppedPlant], float], str]] = {
    "order": lambda tried, _: number(order(tried), 3, zeros=True),
    "errors": lambda tried, _: f"{number(tried[0].joints, 2)} to {number(tried[-1].joints, 2)}",
    "knee": _at_knee,
    "step": _at_step,
}
_NUMBERS: Mapping[str, Callable[[list[SteppedPlant], float], float | None]] = {
    "order": lambda tried, _: order(tried),
    "left": lambda tried, _: tried[-1].joints,
    "largest step": lambda tried, allowed: tried[0].tip / allowed,
}
