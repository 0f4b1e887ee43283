"""Figure, tables and numbers of the precision study."""

from collections.abc import Mapping

import numpy as np

from runner.base.quantities import number, quantity
from runner.reporting.document import Curves, Origin, Panel, Series, Table
from runner.reporting.figures import origin
from runner.store import Run
from runner.studies.precision.tried import (
    COMPILED,
    PLANTS,
    Tried,
    allowed_error,
    by_steps,
    knee,
    large_enough,
    order,
    solutions,
)
from runner.study.measured import Measured

_ARMS = {"macro": "Macro", "combined": "Mini on Macro", "xarm7": "xArm7"}
_CASES = {"free": "free", "control": "under control"}
_PAIRS = [(arm, case) for arm in _ARMS for case in _CASES]
_STORED = PLANTS[:3]
_LABELLED = {"PyBullet": -1, "MuJoCo": 0, COMPILED: 0}  # places of the steps named in the figure
_ROOM = (0.1, 100.0)  # around the errors, for what stands above a line


def first_order_plants() -> tuple[str, ...]:
    """Return the plants by Euler's scheme."""
    return PLANTS[:2]


def ours() -> tuple[str, ...]:
    """Return the Runge-Kutta plant, compiled and by Pinocchio."""
    return PLANTS[2:]


def accuracy(runs: Mapping[str, Run], caption: str) -> Curves:
    """Return the tip's error over the computing time, a panel for each arm and case, a line for each plant."""
    panels = []
    for arm, case in _PAIRS:
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
    return Curves(caption, panels, 2, _origin(runs))


def reference_table(runs: Mapping[str, Run], caption: str) -> Table:
    """Return how far the ways to the solution are from each other."""
    header = ["arm", "moves", "another method (rad)", "coarser tolerance (rad)", "energy"]
    rows = []
    for arm, case in _PAIRS:
        own = solutions(runs)[f"{case}/{arm}"]
        told = (own["apart"]["collocation"], own["apart"]["tolerance"], own["energy"])
        rows.append([_ARMS[arm], _CASES[case], *(number(value, 2) for value in told)])
    return Table(caption, header, rows, (2, 3, 4), _origin(runs))


def orders_table(runs: Mapping[str, Run], caption: str) -> Table:
    """Return the order of each plant."""
    header = ["arm", "moves", *PLANTS]
    rows = [
        [
            _ARMS[arm],
            _CASES[case],
            *(number(order(by_steps(runs, case, arm, plant)), 3, zeros=True) for plant in PLANTS),
        ]
        for arm, case in _PAIRS
    ]
    return Table(caption, header, rows, (2, 3, 4, 5), _origin(runs))


def errors(runs: Mapping[str, Run], caption: str) -> Table:
    """Return the largest joint error of each plant by its largest and its smallest step."""
    header = ["arm", "moves", *(f"{plant} (rad)" for plant in _STORED)]
    rows = []
    for arm, case in _PAIRS:
        tried = [by_steps(runs, case, arm, plant) for plant in _STORED]
        texts = [f"{number(each[0].joints, 2)} to {number(each[-1].joints, 2)}" for each in tried]
        rows.append([_ARMS[arm], _CASES[case], *texts])
    return Table(caption, header, rows, (), _origin(runs))


def knees(runs: Mapping[str, Run], caption: str) -> Table:
    """Return below which step of each plant a smaller one is not worth its price, and the joint error left there."""
    rows = []
    for arm, case in _PAIRS:
        row = [_ARMS[arm], _CASES[case]]
        for plant in PLANTS:
            at = knee(by_steps(runs, case, arm, plant))
            row.append("beyond" if at is None else f"{quantity(at.step, 's')}: {number(at.joints, 2)}")
        rows.append(row)
    return Table(caption, ["arm", "moves", *PLANTS], rows, (), _origin(runs))


def recommended(runs: Mapping[str, Run], caption: str) -> Table:
    """Return the largest step of each plant whose error is small enough, and its computing time."""
    rows = []
    for arm, case in _PAIRS:
        row = [_ARMS[arm], _CASES[case], quantity(allowed_error(runs, case, arm), "m")]
        for plant in PLANTS:
            at = _large_enough(runs, case, arm, plant)
            row.append("none" if at is None else f"{quantity(at.step, 's')}: {quantity(at.seconds, 's', 2)}")
        rows.append(row)
    return Table(caption, ["arm", "moves", "error allowed", *PLANTS], rows, (), _origin(runs))


def distances(runs: Mapping[str, Run], words: str, way: str) -> list[Measured]:
    """Return how far another way to the solution of each case and arm is from it, in rad."""
    return [Measured(f"{words}: {name}", float(own["apart"][way]), "rad") for name, own in solutions(runs).items()]


def drifts(runs: Mapping[str, Run], words: str) -> list[Measured]:
    """Return the change of energy along the solution of each free motion, over its largest kinetic energy."""
    known = {name: own["energy"] for name, own in solutions(runs).items() if own["energy"] is not None}
    return [Measured(f"{words}: {name}", float(energy)) for name, energy in known.items()]


def orders(runs: Mapping[str, Run], words: str, *plants: str) -> list[Measured]:
    """Return the order of some plants on each arm and case."""
    return [
        Measured(_named(words, arm, case, plant), order(by_steps(runs, case, arm, plant)))
        for plant in plants
        for arm, case in _PAIRS
    ]


def compiled_apart(runs: Mapping[str, Run], words: str) -> list[Measured]:
    """Return how far the errors of Runge-Kutta, compiled and by Pinocchio, are from each other, in rad."""
    told = []
    for arm, case in _PAIRS:
        ways = (by_steps(runs, case, arm, plant) for plant in ours())
        most = max(abs(one.joints - other.joints) for one, other in zip(*ways, strict=True))
        told.append(Measured(_named(words, arm, case), most, "rad"))
    return told


def left_at_finest(runs: Mapping[str, Run], words: str, *plants: str) -> list[Measured]:
    """Return the joint error of some plants on each arm and case by their smallest step, in rad."""
    return [
        Measured(_named(words, arm, case, plant), by_steps(runs, case, arm, plant)[-1].joints, "rad")
        for plant in plants
        for arm, case in _PAIRS
    ]


def by_whole_periods(runs: Mapping[str, Run], words: str) -> list[Measured]:
    """Return the tip's error over that allowed, of Runge-Kutta by its largest step."""
    return [
        Measured(_named(words, arm, case), by_steps(runs, case, arm, COMPILED)[0].tip / allowed_error(runs, case, arm))
        for arm, case in _PAIRS
    ]


def without_knee(runs: Mapping[str, Run], words: str, *plants: str) -> Measured:
    """Return how often some plants gain by every smaller step that was tried."""
    found = [knee(by_steps(runs, case, arm, plant)) for plant in plants for arm, case in _PAIRS]
    return Measured(words, found.count(None))


def without_step(runs: Mapping[str, Run], words: str, *plants: str) -> Measured:
    """Return how often no step of some plants leaves an error that is small enough."""
    found = [_large_enough(runs, case, arm, plant) for plant in plants for arm, case in _PAIRS]
    return Measured(words, found.count(None))


def cases_of(*plants: str) -> int:
    """Return how many arms and cases there are of some plants."""
    return len(_PAIRS) * len(plants)


def _large_enough(runs: Mapping[str, Run], case: str, arm: str, plant: str) -> Tried | None:
    return large_enough(by_steps(runs, case, arm, plant), allowed_error(runs, case, arm))


def _named(words: str, arm: str, case: str, plant: str = "") -> str:
    return f"{words}: {', '.join(text for text in (plant, _ARMS[arm], _CASES[case]) if text)}"


def _origin(runs: Mapping[str, Run]) -> Origin:
    return origin(next(iter(runs.values())))
