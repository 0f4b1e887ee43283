"""Published numbers as data, read from the claims file of a study."""

from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from runner.base.data_file import read_data
from runner.base.errors import RunnerError
from runner.base.paths import studies_dir, studies_with
from runner.schema.model import StrictModel

FILE = "claims.yaml"


class Bound(StrictModel):
    """What another number of the same source leads one to expect at most.

    Attributes:
        claim: Number of the claim that has the other number.
        scale: What that is multiplied by.
        name: What the simulated number, so multiplied, is called at the start of a sentence.
        reason: Why the one follows from the other, and how strictly; inline mathematics between dollar signs.
    """

    claim: int
    scale: PositiveFloat
    name: str
    reason: str


class Likeness(StrictModel):
    """What a claim without a number is compared with: another run.

    Attributes:
        experiment: The other experiment, or the begin of its run's name.
        metric: The metric there.
    """

    experiment: str
    metric: str


class Extent(StrictModel):
    """Where the tip moves along one axis of the base.

    Attributes:
        axis: The axis.
        span: Distance between its least and its largest coordinate, in m.
        middle: What lies half way between them, in m; None where nothing is said of it.
        tolerance: How far the simulated ones may be from these, in m: half a unit of the last printed digit.
    """

    axis: Literal["x", "y", "z"]
    span: NonNegativeFloat
    middle: float | None = None
    tolerance: PositiveFloat

    def met(self, path: NDArray[np.float64]) -> bool:
        """Tell whether a path, shape (T, 3), in m, has this extent; one that has gaps (NaN) has not."""
        values = path[:, "xyz".index(self.axis)]
        low, high = values.min(), values.max()
        wide = bool(abs(high - low - self.span) <= self.tolerance)
        ends = (low + 0.5 * self.span, high - 0.5 * self.span)
        return wide and (self.middle is None or all(abs(end - self.middle) <= self.tolerance for end in ends))


class PublishedClaim(StrictModel):
    """One published number.

    Attributes:
        number: Its number in the list.
        statement: What the source says.
        place: Where.
        printed: The printed value, or the two ends of the printed range; empty where the source compares in words.
        unit: Its unit.
        experiment: The experiment that makes it: of "study/name" the run of the study is name/PRESET.
        run: Where no experiment makes it: begin of the run's name, name for name/PRESET.
        metric: The metric that it is compared with; a range is compared by its upper end, the worst axis.
        extents: Where it says how the tip moves, in place of a metric.
        fails: Whether it says that this motion is not met.
        reason: What the comparison shows; inline mathematics between dollar signs.
        like: Set where the source compares in words: the run that it is said to be like.
        bound: Set where another number of the source speaks against this one.
        longer: Begin of the name of a run of the same motion that lasts longer, which shows whether the verdict hangs
            on the end of the run; empty for none.
    """

    number: int
    statement: str
    place: str
    printed: Annotated[list[NonNegativeFloat], Field(max_length=2)]
    unit: str
    experiment: str = ""
    run: str = ""
    metric: str = ""
    extents: list[Extent] = Field(default_factory=list)
    fails: bool = False
    reason: str
    bound: Bound | None = None
    like: Likeness | None = None
    longer: str = ""

    @model_validator(mode="after")
    def _check_comparison(self) -> Self:
        if bool(self.metric) == bool(self.extents):
            raise ValueError("is compared by metric or by extents, one of the two")
        if bool(self.experiment) == bool(self.run):
            raise ValueError("names an experiment or a run, one of the two")
        return self

    @property
    def value(self) -> float | None:
        """The printed value that is compared with: the upper end of a range; None where there is no number."""
        return self.printed[-1] if self.printed else None


def studies_with_claims() -> list[str]:
    """Return the names of the studies that have claims, sorted."""
    return studies_with(FILE)


def load_claims(study: str | Path) -> list[PublishedClaim]:
    """Return the published numbers of a study in order.

    Args:
        study: One of ours by its name, such as "thesis", or the whole path of a study's folder.

    Raises:
        RunnerError: if its file does not fit, or a bound names no claim of it; names the file, the entries and keys.
    """
    path = studies_dir() / study / FILE
    claims = read_data(path, list[PublishedClaim])
    numbers = [claim.number for claim in claims]
    for claim in claims:
        if claim.bound is not None and claim.bound.claim not in numbers:
            raise RunnerError(f"{path}: claim {claim.number}: bound.claim: there is no claim {claim.bound.claim}")
    return claims
