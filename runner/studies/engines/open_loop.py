"""Integration error of the plants under constant torques, and its order in the step."""

import math
from collections.abc import Callable, Mapping

from runner.store import Run
from runner.studies.engines.figures import measured, share_of, tip_distance
from runner.study.measured import Measured
from runner.study.prose.patterns import found


def order(coarse: Run, fine: Run, reference: Run) -> float:
    """Return the power of its step with which a plant comes to a reference, from one step to half of it."""
    return math.log2(tip_distance(coarse, reference) / tip_distance(fine, reference))


def orders(runs: Mapping[str, Run], coarse: str, fine: str, *plants: str) -> list[Measured]:
    """Return the order of some plants on each arm, from one step to half of it."""
    found_orders = []
    for plant in plants:
        for arm, reference in _arms(runs):
            first, second = (runs[f"open/{arm}/{plant}/{step}"] for step in (coarse, fine))
            found_orders.append(measured(f"order of {plant}, {arm}", order, "1", first, second, reference))
    return found_orders


def apart_as_share(runs: Mapping[str, Run], plant: str, other: str) -> list[Measured]:
    """Return how far a plant is from another one at 1 ms on each arm, as a share of its error."""
    shares = []
    for arm, reference in _arms(runs):
        first, second = (runs[f"open/{arm}/{each}/0.001"] for each in (plant, other))
        shares.append(measured(f"{plant} from {other}, {arm}", share_of, "1", first, second, reference))
    return shares


def _arms(runs: Mapping[str, Run]) -> list[tuple[str, Run]]:
    """Return the name of each arm in the runs, and its reference."""
    return [(one.levels["arm"], one.run) for one in found(runs, "reference/{arm}/rk4/5e-05")]


def first_order(value: Measured, at: float) -> Callable[[float], float | None]:
    """Return the law that goes with the step and has a value at one."""
    return lambda step: None if value.value is None else value.value * step / at


def fourth_order(value: Measured, at: float) -> Callable[[float], float | None]:
    """Return the law that goes with the fourth power of the step and has a value at one."""
    return lambda step: None if value.value is None else value.value * (step / at) ** 4
