"""Asked case of a challenge: the checked configs of both sides."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.dotted_keys import get
from runner.base.errors import ConfigError
from runner.config.compose.composer import Composer
from runner.store.axes import is_simulated
from runner.sweeps.challenge.goals import other_goals
from runner.sweeps.challenge.question import Question
from runner.sweeps.job import RunJob, check_job
from runner.sweeps.plan import Item, Listed

DRAWN = ("seed", "repetitions", "outputs")
"""Keys that a challenge sets itself."""


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
