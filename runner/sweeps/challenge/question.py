"""Question of a challenge: a metric, two sides and their configs, as a stored result asks it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from runner.base.arrays import FloatArray
from runner.base.dotted_keys import get
from runner.base.errors import ConfigError
from runner.config.compose.composer import Composer
from runner.config.run import RunConfig
from runner.store.axes import is_simulated
from runner.sweeps.challenge.goals import other_goals
from runner.sweeps.job import RunJob, check_job
from runner.sweeps.plan import Item, Listed

DRAWN = ("seed", "repetitions", "outputs")
"""Keys that a challenge sets itself."""


@dataclass(frozen=True)
class Side:
    """A side of the question.

    Attributes:
        name: Name in sentences, such as "operational_space".
        overrides: Overrides of its runs, without seed, repetitions and outputs.
        medians: Median of each metric in the stored result.
    """

    name: str
    overrides: Sequence[str]
    medians: Mapping[str, float]


@dataclass(frozen=True)
class Question:
    """A question with its stored answer.

    Attributes:
        metric: The metric.
        unit: Its unit.
        sides: A and B; the answer describes B against A.
        sign: -1 if B is smaller, 1 if it is larger, 0 if no difference was shown.
        size: Difference of B from A relative to the larger median.
        error: Integration error in the difference; None if it is unknown.
        seed: The first seed that the stored result does not use.
        at: The condition in which it is asked, such as "robot=macro"; empty for the only one.
        left: Number of other conditions of the result, which are not asked.
        config_dirs: Config folders of the user.
        asks: The folders of the stored results.
    """

    metric: str
    unit: str
    sides: tuple[Side, Side]
    sign: int
    size: float
    error: float | None
    seed: int
    at: str
    left: int
    config_dirs: Sequence[Path]
    asks: Sequence[str]

    @property
    def is_fraction(self) -> bool:
        """True for a metric that is a fraction."""
        return "fraction" in self.metric


@dataclass(frozen=True)
class Case:
    """A question with the checked configs of both sides.

    Attributes:
        question: The question.
        configs: Checked config of A and of B.
    """

    question: Question
    configs: tuple[RunConfig, RunConfig]

    def values(self, key: str) -> tuple[Any, Any]:
        """Return the resolved value of a dotted key in both configs; None where it is missing."""
        first, second = (get(config.resolved, key) for config in self.configs)
        return first, second

    @cached_property
    def goals(self) -> list[FloatArray]:
        """Other goals of the motion of A; see `other_goals`."""
        return other_goals(self.configs[0])

    @property
    def peak(self) -> float:
        """The largest torque of both sides in the stored result, in N m; 0 if it is unknown."""
        found = [side.medians.get("peak_torque", 0.0) for side in self.question.sides]
        return max(found)


def own_overrides(overrides: Sequence[str]) -> tuple[str, ...]:
    """Return the overrides of a stored run that a challenge keeps."""
    return tuple(text for text in overrides if text.partition("=")[0] not in DRAWN and is_simulated(text))


def check_case(question: Question) -> Case:
    """Check the configs of both sides.

    Raises:
        ConfigError: if a side can no longer be composed.
    """
    items = {str(place): Item(tuple(side.overrides)) for place, side in enumerate(question.sides)}
    plan = Listed(items, (), Composer(question.config_dirs))
    jobs = [check_job(plan.composed(cell)) for cell in range(len(plan))]
    runs = [job.config for job in jobs if isinstance(job, RunJob)]
    if len(runs) != len(question.sides):
        raise ConfigError("challenge: a side is a calibration. Allowed: runs")
    return Case(question, (runs[0], runs[1]))
