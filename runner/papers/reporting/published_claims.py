"""Published claims as data, and verdicts on them from printed and simulated values."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from runner.base.data_file import read_data
from runner.base.errors import RunnerError
from runner.base.paths import studies_dir
from runner.schema.bound import Range
from runner.schema.model import StrictModel

CLAIMS = "claims.yaml"
STATEMENTS = "statements.yaml"
FACTOR = 1.5
"""By which factor a simulated value may differ from a printed one that it matches: sources read theirs off plots."""
Verdict = Literal[
    "matches", "differs", "smaller than printed", "larger than printed", "source contradicts itself", "undecided"
]
CONTRADICTION: Verdict = "source contradicts itself"
_VERDICTS: Mapping[str, Verdict] = {
    "below": "smaller than printed",
    "within": "matches",
    "above": "larger than printed",
}
Simulated = Callable[[str, str], float | None]
"""Gives the simulated value of a metric of a run, whose name is given without the preset; None for no value."""


class ExpectedLimit(StrictModel):
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


class Simulation(StrictModel):
    """A simulated number: a metric of a run.

    Attributes:
        experiment: The experiment that makes the run: that of "study/name" is called name/PRESET.
        run: If no experiment makes it: the run's name without the preset, such as goal of goal/PRESET or stiff/f20 of
            stiff/f20/PRESET.
        metric: The metric.
    """

    experiment: str = ""
    run: str = ""
    metric: str = ""

    @model_validator(mode="after")
    def _check_one_run(self) -> Self:
        if bool(self.experiment) == bool(self.run):
            raise ValueError("names an experiment or a run, one of the two")
        return self

    @property
    def simulated_by(self) -> tuple[str, str]:
        """Name of the run without the preset, and the metric."""
        return self.run or self.experiment.rpartition("/")[2], self.metric


class Likeness(Simulation):
    """The other run that a claim without a number is compared with."""

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
        """Return True if a path, shape (T, 3), in m, has this extent; False if it has gaps (NaN)."""
        values = path[:, "xyz".index(self.axis)]
        low, high = values.min(), values.max()
        near = Range(-self.tolerance, self.tolerance)
        ends = (low + 0.5 * self.span, high - 0.5 * self.span)
        met = near.holds(high - low - self.span)
        return bool(met and (self.middle is None or all(near.holds(end - self.middle) for end in ends)))


class PublishedClaim(Simulation):
    """One published number.

    Attributes:
        number: Its number in the list.
        statement: What the source says.
        place: Where.
        printed: The printed value, or the two ends of the printed range; empty where the source compares in words.
        unit: Its unit.
        experiment: See Simulation, also for `run` and `metric`; a range is compared by its upper end, the worst axis.
        extents: Where it says how the tip moves, instead of a metric.
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
    extents: list[Extent] = Field(default_factory=list)
    fails: bool = False
    reason: str
    bound: ExpectedLimit | None = None
    like: Likeness | None = None
    longer: str = ""

    @model_validator(mode="after")
    def _check_comparison(self) -> Self:
        if bool(self.metric) == bool(self.extents):
            raise ValueError("is compared by metric or by extents, one of the two")
        return self

    @property
    def value(self) -> float | None:
        """The printed value that is compared with: the upper end of a range; None where there is no number."""
        return self.printed[-1] if self.printed else None


def load_claims(study: str | Path) -> list[PublishedClaim]:
    """Return the published numbers of a study in order.

    Args:
        study: One of ours by its name, such as "thesis", or the whole path of a study's folder.

    Raises:
        RunnerError: if its file does not fit, or a bound names no claim of it; names the file, the entries and keys.
    """
    path = studies_dir() / study / CLAIMS
    claims = read_data(path, list[PublishedClaim])
    numbers = [claim.number for claim in claims]
    for claim in claims:
        if claim.bound is not None and claim.bound.claim not in numbers:
            raise RunnerError(f"{path}: claim {claim.number}: bound.claim: there is no claim {claim.bound.claim}")
    return claims


class PublishedStatement(StrictModel):
    """One statement, which findings on many runs judge.

    Attributes:
        name: A short name, by which its judgement is found.
        statement: What the source says.
        place: Where.
        reason: What is to be said of the verdict; inline mathematics between dollar signs.
    """

    name: str
    statement: str
    place: str
    reason: str = ""


def load_statements(study: str | Path) -> list[PublishedStatement]:
    """Return the statements of a study in order.

    Args:
        study: One of ours by its name, such as "meca500", or the whole path of a study's folder.

    Raises:
        RunnerError: if its file does not fit; names the file, the entries and keys.
    """
    return read_data(studies_dir() / study / STATEMENTS, list[PublishedStatement])


def judge(printed: float, measured: float | None, bound: float | None = None) -> Verdict:
    """Return the verdict on a published number, a time or an error.

    Args:
        printed: The printed value.
        measured: The simulated median; None where most runs have no value, such as a tip that never settles.
        bound: What other numbers of the same source lead one to expect at most, where there is such a bound.

    Returns:
        "source contradicts itself" when even the bound, widened by FACTOR, stays below the printed value; else
        "matches" within FACTOR, "smaller than printed" below it, and "larger than printed" above it.
    """
    if bound is not None and Range(high=bound * FACTOR).exceeded(printed):
        return CONTRADICTION
    return _VERDICTS[Range(printed / FACTOR, printed * FACTOR).verdict(measured)]


def judge_motion(
    extents: Sequence[Extent], fails: bool, tip: NDArray[np.float64], desired: NDArray[np.float64]
) -> Verdict:
    """Return the verdict on what a source says of the tip's motion.

    Args:
        extents: The motion that it tells.
        fails: Whether it says that this motion is not met.
        tip: Path of the tip, shape (T, 3), in m.
        desired: Desired path at the same times, shape (T, 3), in m.

    Returns:
        "source contradicts itself" when its own desired path is another motion; else "matches" where the tip moves as
        stated, or fails to where the source says so, and "differs" where not.
    """
    met = all(extent.met(tip) for extent in extents)
    if not fails and not all(extent.met(desired) for extent in extents):
        return CONTRADICTION
    return "matches" if met != fails else "differs"


def compared_with(claim: PublishedClaim, simulated: Simulated) -> float | None:
    """Return the reference of a claim's simulated value: the printed value, or the run that it is said to be like.

    None where that run has no value.
    """
    return claim.value if claim.like is None else simulated(*claim.like.simulated_by)


def scale_bound(bound: ExpectedLimit, claims: Sequence[PublishedClaim], simulated: Simulated) -> float | None:
    """Return the number to expect from the simulated number of the other claim that a bound names."""
    value = simulated(*_other(bound, claims).simulated_by)
    return None if value is None else value * bound.scale


def expected_value(claim: PublishedClaim, claims: Sequence[PublishedClaim], simulated: Simulated) -> float | None:
    """Return the number to expect from the source's other number, or from the simulated one where that is larger.

    None where the claim has no bound.
    """
    bound = claim.bound
    if bound is None:
        return None
    printed = _other(bound, claims).value
    both = [None if printed is None else printed * bound.scale, scale_bound(bound, claims, simulated)]
    return max((value for value in both if value is not None), default=None)


def verdict_on(claim: PublishedClaim, claims: Sequence[PublishedClaim], simulated: Simulated) -> Verdict | None:
    """Return the verdict on a claim that is compared by a metric; None where it is like a run without a value.

    Args:
        claim: The claim.
        claims: All claims of its study: a bound names another.
        simulated: Gives the simulated values.
    """
    printed = compared_with(claim, simulated)
    if printed is None:
        return None
    verdict = judge(printed, simulated(*claim.simulated_by), expected_value(claim, claims, simulated))
    return "differs" if claim.like is not None and verdict != "matches" else verdict


def _other(bound: ExpectedLimit, claims: Sequence[PublishedClaim]) -> PublishedClaim:
    return next(claim for claim in claims if claim.number == bound.claim)
