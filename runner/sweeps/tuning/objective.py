"""Objectives of a tuning, and its finished trials."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from runner.base.errors import RunnerError, unknown
from runner.plugins.metric_units import unit_of, units
from runner.store import Run

Direction = Literal["minimize", "maximize"]


@dataclass(frozen=True)
class Objective:
    """Metric and the direction in which it improves; the value of a run is the median over the repetitions.

    Attributes:
        metric: Name of the metric.
        direction: Direction in which the metric improves.

    Raises:
        RunnerError: If there is no such metric.
    """

    metric: str
    direction: Direction

    def __post_init__(self) -> None:
        if unit_of(self.metric) is None:
            raise RunnerError(
                f"{unknown('metric', self.metric, units(), f'--{self.direction}')} Also allowed: a metric of one joint "
                "or axis (peak_torque_q1), or of a carrying stage (macro_settling_time)."
            )

    @property
    def unit(self) -> str:
        """Unit of the metric."""
        return unit_of(self.metric) or ""

    @property
    def sign(self) -> float:
        """1 if lower values are better, otherwise -1."""
        return 1.0 if self.direction == "minimize" else -1.0

    @property
    def worst(self) -> float:
        """Worst possible value."""
        return self.sign * math.inf

    def read(self, run: Run) -> float | None:
        """Return the median of the metric in a successful run, or None if it is beyond every number.

        Raises:
            RunnerError: If runs of this kind have no such metric.
        """
        if self.metric not in run.metrics:
            raise RunnerError(unknown("metric of these runs", self.metric, run.metrics, f"--{self.direction}"))
        return run.metrics[self.metric].median


@dataclass(frozen=True)
class Trial:
    """Finished trial: parameters and result.

    Attributes:
        params: Value of each tuned key.
        values: Value of each objective; the worst possible value if the trial failed.
        run: Hash of the run; empty if the config could not be run.
        failure: Reason of the failure; empty for a successful trial.
    """

    params: Mapping[str, float]
    values: tuple[float, ...]
    run: str
    failure: str


def best(trials: Sequence[Trial], objectives: Sequence[Objective]) -> list[int]:
    """Return the numbers of the best trials: the first best for one objective, the Pareto front for several.

    The front contains each successful trial that no other trial dominates, and only the first of equal trials. It is
    sorted by the first objective, the best value first.
    """
    good = [number for number, trial in enumerate(trials) if not trial.failure]
    signs = np.array([objective.sign for objective in objectives])
    losses = np.array([trials[number].values for number in good]).reshape(len(good), len(signs)) * signs
    front: list[int] = []
    for place in np.lexsort(losses.T[::-1]).tolist():
        # In this order, no later trial can dominate or equal a trial that is already in the front.
        if not any((losses[other] <= losses[place]).all() for other in front):
            front.append(place)
    return [good[place] for place in front]
