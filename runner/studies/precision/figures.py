"""Figure, tables and numbers of the precision study."""

from collections.abc import Callable, Sequence

import numpy as np

from runner.base.quantities import number, quantity
from runner.reporting.document import Curves, Panel, Series, Table
from runner.reporting.figures import origin
from runner.reporting.table import Column, numbers
from runner.studies.precision.tried import COMPILED, PLANTS, Tried, allowed_error, by_steps, knee, order, solutions
from runner.study.measured import Measured
from runner.study.results import Runs

_ARMS = {"macro": "Macro", "combined": "Mini on Macro", "xarm7": "xArm7"}
_CASES = {"free": "free", "control": "under control"}
_PAIRS = [(case, arm) for arm in _ARMS for case in _CASES]
_LABELLED = {"PyBullet": -1, "MuJoCo": 0, COMPILED: 0}  # places of the steps named in the figure
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


def reference_table(runs: Runs, caption: str) -> Table:
    """Return a table of the differences between the ways to the solution."""
    header = numbers("another method (rad)", "coarser tolerance (rad)", "energy")

    def cells(case: str, arm: str) -> list[str]:
        own = solutions(runs)[f"{case}/{arm}"]
        return [number(value, 2) for value in (own["apart"]["collocation"], own["apart"]["tolerance"], own["energy"])]

    return _table(runs, caption, header, cells)


def orders_table(runs: Runs, caption: str) -> Table:
    """Return the order of each plant."""
    return _by_plant(runs, caption, lambda tried, _: number(order(tried), 3, zeros=True), numeric=True)


def errors(runs: Runs, caption: str) -> Table:
    """Return the largest joint error of each plant by its largest and its smallest step."""
    header = [f"{plant} (rad)" for plant in PLANTS[:3]]

    def cells(case: str, arm: str) -> list[str]:
        tried = [by_steps(runs, case, arm, plant) for plant in PLANTS[:3]]
        return [f"{number(each[0].joints, 2)} to {number(each[-1].joints, 2)}" for each in tried]

    return _table(runs, caption, header, cells)


def knees(runs: Runs, caption: str) -> Table:
    """Return the step of each plant below which a smaller one does not pay, and the joint error left there."""

    def cell(tried: list[Tried], _: float) -> str:
        at = knee(tried)
        return "beyond" if at is None else f"{quantity(at.step, 's')}: {number(at.joints, 2)}"

    return _by_plant(runs, caption, cell)


def recommended(runs: Runs, caption: str) -> Table:
    """Return the largest step of each plant whose error is small enough, and its computing time."""

    def cell(tried: list[Tried], allowed: float) -> str:
        at = large_enough(tried, allowed)
        return "none" if at is None else f"{quantity(at.step, 's')}: {quantity(at.seconds, 's', 2)}"

    return _by_plant(runs, caption, cell, "error allowed")


def of_solutions(runs: Runs, words: str, key: str, way: str = "", unit: str = "1") -> list[Measured]:
    """Return a number of the solution of each case and arm that has it, such as its distance from another way to it."""
    known = {name: own[key][way] if way else own[key] for name, own in solutions(runs).items()}
    return [Measured(f"{words}: {name}", float(own), unit) for name, own in known.items() if own is not None]


def orders(runs: Runs, words: str, *plants: str) -> list[Measured]:
    """Return the order of some plants on each arm and case."""
    return _each(runs, words, "1", lambda tried, _: order(tried), *plants)


def left_at_finest(runs: Runs, words: str, *plants: str) -> list[Measured]:
    """Return the joint error of some plants on each arm and case by their smallest step, in rad."""
    return _each(runs, words, "rad", lambda tried, _: tried[-1].joints, *plants)


def by_whole_periods(runs: Runs, words: str) -> list[Measured]:
    """Return the tip's error over that allowed, of Runge-Kutta by its largest step."""
    return _each(runs, words, "1", lambda tried, allowed: tried[0].tip / allowed, COMPILED)


def compiled_apart(runs: Runs, words: str) -> list[Measured]:
    """Return the largest difference between the errors of Runge-Kutta, compiled and by Pinocchio, in rad."""

    def apart(case: str, arm: str) -> float:
        both = (by_steps(runs, case, arm, plant) for plant in PLANTS[2:])
        return max(abs(float(one.joints - other.joints)) for one, other in zip(*both, strict=True))

    return [Measured(f"{words}: {_ARMS[arm]}, {_CASES[case]}", apart(case, arm), "rad") for case, arm in _PAIRS]


def without_knee(runs: Runs, words: str, *plants: str) -> Measured:
    """Return the number of arms and cases in which some plants gain by every smaller step that was tried."""
    return _count(runs, words, lambda tried, _: knee(tried), *plants)


def without_step(runs: Runs, words: str, *plants: str) -> Measured:
    """Return the number of arms and cases in which no step of some plants leaves an error that is small enough."""
    return _count(runs, words, large_enough, *plants)


def large_enough(tried: list[Tried], allowed: float) -> Tried | None:
    """Return the largest step with a tip error, in m, below what is allowed; None if there is none."""
    return next((each for each in tried if each.tip < allowed), None)


def _each(
    runs: Runs, words: str, unit: str, of: Callable[[list[Tried], float], float | None], *plants: str
) -> list[Measured]:
    return [
        Measured(f"{words}: {plant}, {_ARMS[arm]}, {_CASES[case]}", of(*_tried(runs, case, arm, plant)), unit)
        for plant in plants
        for case, arm in _PAIRS
    ]


def _count(runs: Runs, words: str, of: Callable[[list[Tried], float], Tried | None], *plants: str) -> Measured:
    found = [of(*_tried(runs, case, arm, plant)) for plant in plants for case, arm in _PAIRS]
    return Measured(words, found.count(None))


def _tried(runs: Runs, case: str, arm: str, plant: str) -> tuple[list[Tried], float]:
    return by_steps(runs, case, arm, plant), allowed_error(runs, case, arm)


def _by_plant(
    runs: Runs, caption: str, cell: Callable[[list[Tried], float], str], allowed: str = "",
    numeric: bool = False,
) -> Table:  # fmt: skip
    """Return a table with a column for each plant, behind one for the error that is allowed if it has a title."""

    def cells(case: str, arm: str) -> list[str]:
        first = [quantity(allowed_error(runs, case, arm), "m")] if allowed else []
        return [*first, *(cell(*_tried(runs, case, arm, plant)) for plant in PLANTS)]

    plants = numbers(*PLANTS) if numeric else PLANTS
    return _table(runs, caption, [allowed, *plants] if allowed else plants, cells)


def _table(runs: Runs, caption: str, header: Sequence[str | Column], cells: Callable[[str, str], list[str]]) -> Table:
    rows = [[_ARMS[arm], _CASES[case], *cells(case, arm)] for case, arm in _PAIRS]
    return Table(caption, ["arm", "moves", *header], rows, origin(next(iter(runs.values()))))
