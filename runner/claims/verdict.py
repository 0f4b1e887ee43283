"""From a printed and a simulated value to a verdict."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from runner.claims.claim import Extent

FACTOR = 1.5
"""By which factor the simulated value may differ from a printed one that holds: the sources read theirs off plots."""

Verdict = Literal["holds", "better", "worse", "contradicts itself"]
CONTRADICTION: Verdict = "contradicts itself"


def judge(printed: float, measured: float | None, bound: float | None = None) -> Verdict:
    """Return the verdict on a published number for which less is better (times and errors).

    Args:
        printed: The printed value.
        measured: The simulated median; None where most runs have no value, such as a tip that never settles.
        bound: What other numbers of the same source lead one to expect at most, where there is such a bound.

    Returns:
        "contradicts itself" when even the bound, widened by FACTOR, stays below the printed value; else "holds" within
        FACTOR, "better" below and "worse" above it.
    """
    if bound is not None and bound * FACTOR < printed:
        return CONTRADICTION
    if measured is None or measured > printed * FACTOR:
        return "worse"
    return "better" if measured < printed / FACTOR else "holds"


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
        "contradicts itself" when the source's own desired path is another motion; else "holds" where the tip
        moves as told, and "worse" where it does not. Where the source says that it fails, "holds" when it does and
        "better" when not.
    """
    met = all(extent.met(tip) for extent in extents)
    if fails:
        return "better" if met else "holds"
    if not all(extent.met(desired) for extent in extents):
        return CONTRADICTION
    return "holds" if met else "worse"
