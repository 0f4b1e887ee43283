"""The published numbers as data."""

from importlib.resources import files
from typing import Annotated

import yaml
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.registry import StrictModel


class Bound(StrictModel):
    """Why a printed number cannot be reached: the model's own upper bound for it, taken from another run.

    Attributes:
        experiment: The experiment that bounds it.
        metric: The metric there.
        scale: What it is multiplied with.
        reason: Why that bounds the number; inline mathematics between dollar signs.
    """

    experiment: str
    metric: str
    scale: PositiveFloat
    reason: str


class Likeness(StrictModel):
    """What a claim without a number is compared with: ours of another run.

    Attributes:
        experiment: The other experiment.
        metric: The metric there.
    """

    experiment: str
    metric: str


class PublishedClaim(StrictModel):
    """One published number.

    Attributes:
        number: Its number in the list.
        statement: What the source says.
        place: Where.
        printed: The printed value, or the two ends of the printed range; empty where the source compares in words.
        unit: Its unit.
        experiment: The experiment that makes it.
        metric: The metric that it is compared with; a range is compared by its upper end, the worst axis.
        reason: What the comparison shows; inline mathematics between dollar signs.
        like: Set where the source compares in words: the run of ours that it is said to be like.
        bound: Set where the number is beyond what the model can give.
    """

    number: int
    statement: str
    place: str
    printed: Annotated[list[NonNegativeFloat], Field(max_length=2)]
    unit: str
    experiment: str
    metric: str
    reason: str
    bound: Bound | None = None
    like: Likeness | None = None

    @property
    def value(self) -> float | None:
        """The printed value that ours is compared with: the upper end of a range; None where there is no number."""
        return self.printed[-1] if self.printed else None


def load_claims(source: str) -> list[PublishedClaim]:
    """Return the published numbers of a source, such as "thesis", in order."""
    entries = yaml.safe_load((files("runner.claims") / f"{source}.yaml").read_text())
    return [PublishedClaim.model_validate(entry) for entry in entries]
