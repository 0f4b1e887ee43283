"""Asked case of a challenge: the checked configs of the sides whose results are compared."""

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
from runner.sweeps.challenge.question import Question, Side
from runner.sweeps.job import RunJob, check_job
from runner.sweeps.plan import Item, Listed

DRAWN = ("seed", "repetitions", "outputs")
"""Keys that a challenge sets itself."""

_TENTH = 0.1  # of the difference: integration error that a finer step must reach


@dataclass(frozen=True)
class Case:
    """Sides with their checked configs: A and B of a question, or the runs of a finding.

    Attributes:
        sides: The sides.
        configs: Checked config of each side.
        most_step: Largest share of the plant's step at which the integration error is small enough.
    """

    sides: Sequence[Side]
    configs: Sequence[RunConfig]
    most_step: float = 1.0

    def values(self, key: str) -> list[Any]:
        """Return the resolved value of a dotted key in each config; None where it is missing."""
        return [get(config.resolved, key) for config in self.configs]

    @cached_property
    def goals(self) -> list[FloatArray]:
        """Other goals of the motion of the first side; see `other_goals`."""
        return other_goals(self.configs[0])

    @property
    def peak(self) -> float:
        """The largest torque of all sides in the stored result, in N m; 0 if it is unknown."""
        return max(side.medians.get("peak_torque", 0.0) for side in self.sides)


def own_overrides(overrides: Sequence[str]) -> tuple[str, ...]:
    """Return the overrides of a stored run that a challenge keeps."""
    return tuple(text for text in overrides if text.partition("=")[0] not in DRAWN and is_simulated(text))


def check_case(question: Question, composer: Composer | None = None) -> Case:
    """Check the configs of both sides of a question.

    Args:
        question: The question.
        composer: Composer of the configs; None for a new one.

    Raises:
        ConfigError: if a side can no longer be composed.
    """
    step = 1.0
    if question.error and question.size:
        largest = max(abs(side.medians.get(question.metric, 0.0)) for side in question.sides)
        step = _TENTH * abs(question.size) * largest / question.error
    composer = composer or Composer(question.config_dirs)
    return Case(question.sides, check_sides(question.sides, composer), step)


def check_sides(sides: Sequence[Side], composer: Composer) -> list[RunConfig]:
    """Return the checked config of each side.

    Raises:
        ConfigError: if one can no longer be composed.
    """
    items = {str(place): Item(tuple(side.overrides)) for place, side in enumerate(sides)}
    plan = Listed(items, (), composer)
    jobs = [check_job(plan.composed(cell)) for cell in range(len(plan))]
    runs = [job.config for job in jobs if isinstance(job, RunJob)]
    if len(runs) != len(sides):
        raise ConfigError("challenge: a side is a calibration. Allowed: runs")
    return runs
