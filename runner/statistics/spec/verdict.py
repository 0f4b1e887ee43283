"""Verdict on a bound, from the fraction of repetitions within it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from runner.statistics.proportion import Share


@dataclass(frozen=True)
class Verdict:
    """What the repetitions say of a bound.

    Attributes:
        says: It is kept; it is broken; or they are too few to tell.
        needed: How many repetitions in all would tell, where these do not and the share stays what it is; None where
            no number would, or these do.
    """

    says: Literal["kept", "broken", "untold"]
    needed: int | None = None


def judge_share(share: "Share", at_most: float | None) -> Verdict:
    """Return what the repetitions say.

    Args:
        share: Those that keep the bound.
        at_most: The largest probability of failing that is allowed, above 0 and below 1; the whole 95 % interval has
            to lie below it. None where no repetition may fail: nothing is said of the probability then.
    """
    if at_most is None:
        return Verdict("kept" if share.kept == share.of else "broken")
    failing = share.rest
    if failing.high < at_most:
        return Verdict("kept")
    if failing.low > at_most:
        return Verdict("broken")
    from runner.statistics.proportion import needed_repetitions

    return Verdict("untold", needed_repetitions(failing, at_most))
