"""Finished trial of a tuning, and the best trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.sweeps.tuning.objective import Objective


@dataclass(frozen=True)
class Trial:
    """What was tried, and what came of it.

    Attributes:
        params: Value of each tuned key.
        values: Value of each objective; the worst there is where the trial failed.
        run: Hash of its run; empty where its config could not be run.
        failure: Why it failed; empty for a good one.
    """

    params: Mapping[str, float]
    values: tuple[float, ...]
    run: str
    failure: str


def best(trials: Sequence[Trial], objectives: Sequence[Objective]) -> list[int]:
    """Return the numbers of the best trials: of one objective the first best, of several the Pareto front.

    On the front stands a good trial that no other beats in one objective without losing in another, by ascending
    (descending where more is better) first objective; of equal ones the first.
    """
    good = [number for number, trial in enumerate(trials) if not trial.failure]
    signs = np.array([objective.sign for objective in objectives])
    losses = np.array([trials[number].values for number in good]).reshape(len(good), len(signs)) * signs
    front: list[int] = []
    for place in np.lexsort(losses.T[::-1]).tolist():
        # In this order nothing that comes later can beat or equal what stands on the front.
        if not any((losses[other] <= losses[place]).all() for other in front):
            front.append(place)
    return [good[place] for place in front]
