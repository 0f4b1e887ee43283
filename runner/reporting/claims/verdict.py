"""Verdict from a printed and a simulated value."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from runner.reporting.claims.claim import Extent

FACTOR = 1.5
"""By which factor a simulated value may differ from a printed one that it matches: sources read theirs off plots."""

Verdict = Literal[
    "matches", "differs", "smaller than printed", "larger than printed", "source contradicts itself", "undecided"
]
CONTRADICTION: Verdict = "source contradicts itself"


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
    if bound is not None and bound * FACTOR < printed:
        return CONTRADICTION
    if measured is None or measured > printed * FACTOR:
        return "larger than printed"
    return "smaller than printed" if measured < printed / FACTOR else "matches"


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
        told, or fails to where the source says so, and "differs" where not.
    """
    met = all(extent.met(tip) for extent in extents)
    if not fails and not all(extent.met(desired) for extent in extents):
        return CONTRADICTION
    return "matches" if met != fails else "differs"
