"""Verdict on a published claim from simulated values: medians of a run, or values of some seeds."""

from collections.abc import Callable, Sequence

from runner.reporting.claims.claim import Bound, PublishedClaim
from runner.reporting.claims.verdict import Verdict, judge

Simulated = Callable[[str, str], float | None]
"""Gives the simulated value of a metric of an experiment, or of a run by the begin of its name; None for none."""


def simulated_by(claim: PublishedClaim) -> tuple[str, str]:
    """Return the experiment, or the begin of the run's name, that makes a claim's number, and the metric."""
    return claim.experiment or claim.run, claim.metric


def compared_with(claim: PublishedClaim, simulated: Simulated) -> float | None:
    """Return what a claim's simulated value is held against: the printed value, or the run that it is said to be like.

    None where that run has no value.
    """
    return claim.value if claim.like is None else simulated(claim.like.experiment, claim.like.metric)


def scale_bound(bound: Bound, claims: Sequence[PublishedClaim], simulated: Simulated) -> float | None:
    """Return what the simulated number of the other claim that a bound names leads one to expect."""
    value = simulated(*simulated_by(_other(bound, claims)))
    return None if value is None else value * bound.scale


def expected_value(claim: PublishedClaim, claims: Sequence[PublishedClaim], simulated: Simulated) -> float | None:
    """Return what the source's other number, or the simulated one in its place where larger, lets one expect.

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
    verdict = judge(printed, simulated(*simulated_by(claim)), expected_value(claim, claims, simulated))
    return "differs" if claim.like is not None and verdict != "matches" else verdict


def _other(bound: Bound, claims: Sequence[PublishedClaim]) -> PublishedClaim:
    return next(claim for claim in claims if claim.number == bound.claim)
