"""From a printed value and ours to a verdict."""

from typing import Literal

FACTOR = 1.5
"""How far ours may be from a printed value that still holds: the sources read theirs off plots, to one digit."""

Verdict = Literal["holds", "better", "worse", "cannot"]


def judge(printed: float, measured: float | None, bound: float | None = None) -> Verdict:
    """Return the verdict on a published number for which less is better (times and errors).

    Args:
        printed: The printed value.
        measured: Our median; None where most runs have no value, such as a tip that never settles.
        bound: The largest value that the model can give, where there is such a bound.

    Returns:
        "cannot" when even the bound, widened by FACTOR, stays below the printed value; else "holds" within FACTOR,
        "better" below and "worse" above it.
    """
    if bound is not None and bound * FACTOR < printed:
        return "cannot"
    if measured is None or measured > printed * FACTOR:
        return "worse"
    return "better" if measured < printed / FACTOR else "holds"
