"""How far a plant and Runge-Kutta are apart on one and the same case."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from runner.engines import has_pybullet
from runner.quantities import above_rounding, quantity
from runner.reporting.figures import columns
from runner.reporting.words import PLANT
from runner.store import Run, find_run, run_hash

_TWINS = {"bullet": "rk4", "mujoco": "rk4", "rk4": "bullet"}
_OF_MUJOCO = ("integrator", "least_inertia", "in_place_of")  # keys that no other plant has


@dataclass(frozen=True)
class Disagreement:
    """Largest difference of two runs that differ in their plant alone.

    Attributes:
        tip: Largest distance between the tips at equal times, in m.
        final: Distance between the tips at the end, in m.
    """

    tip: float
    final: float


def disagreement(run: Run, twin: Run) -> Disagreement:
    """Compare repetition 0 of two runs that differ in their plant alone, at their common times."""
    first, second = run.trace, twin.trace
    rows = min(len(first), len(second))
    distance = np.linalg.norm(columns(first[:rows], "tip") - columns(second[:rows], "tip"), axis=1)
    return Disagreement(float(distance.max()), float(distance[-1]))


def find_twin(run: Run) -> Run | None:
    """Return the stored run of the same case on the other plant, with one or as many repetitions, if there is one."""
    other = _TWINS.get(run.config["plant"]["kind"])
    if other is None:
        return None
    plant = {key: value for key, value in run.config["plant"].items() if key not in _OF_MUJOCO}
    for repetitions in (1, run.config["repetitions"]):
        config = {**run.config, "plant": {**plant, "kind": other, "step": None}, "repetitions": repetitions}
        twin = find_run(run.folder.parent.parent, run_hash(config, run.urdf))
        if twin is not None:
            return twin
    return None


def describe_agreement(run: Run) -> str:
    """Return a sentence on plant, step and the measured disagreement, for a report on that run."""
    plant, step = run.config["plant"]["kind"], run.provenance["plant_step"]
    head = f"{PLANT.get(plant, plant)} is the plant, in steps of {quantity(step, 's')}."
    twin = find_twin(run)
    if twin is None:
        other = _TWINS.get(plant, "rk4")
        if other == "bullet" and not has_pybullet():
            return f"{head} PyBullet, which it would be compared with, is not installed here."
        return (
            f"{head} How far the other plant is from it has not been measured on this case: "
            f"run it with plant={other} and repetitions=1, and make this report again."
        )
    apart = disagreement(run, twin)
    noise = " and the same noise" if _noisy(run) else ""
    return (
        f"{head} With {PLANT[_TWINS[plant]]} in its place{noise} the tip is at most "
        f"{above_rounding(apart.tip, 'm', 2)} away at equal times, and {above_rounding(apart.final, 'm', 2)} at the "
        "end."
    )


def _noisy(run: Run) -> bool:
    """Tell whether the encoders of a run err at random; a noise of none has no effect."""
    noise = run.config["noise"]
    widths = noise["position"].values() if isinstance(noise["position"], Mapping) else (noise["position"],)
    return noise["distribution"] != "none" and any(widths)
