"""Notes on the limits of a comparison: noise draws, pooled cells."""

from collections.abc import Iterable, Mapping
from typing import Any

NOISE_ALONE = (
    "Repetitions differ in their noise draws alone (mismatch.spread is 0): the intervals tell what other draws would "
    "do, not what another arm or another error of the model would."
)

POOLED = (
    "Over all cells each draw counts once, by the mean of its cells. If the difference is above zero in some cells and "
    "below in others, that number describes none of them."
)


def format_count(count: int, one: str, many: str) -> str:
    """Return a number with what is counted, such as "1 cell is" or "2 cells are"."""
    return f"{count} {one if count == 1 else many}"


def noise_alone(configs: Iterable[Mapping[str, Any]]) -> bool:
    """Tell whether the repetitions of runs draw nothing but noise: nothing of the arm is drawn from the seed."""
    mismatches = [config.get("mismatch", {}) for config in configs]
    return all(not mismatch.get("spread") and "kind" not in mismatch for mismatch in mismatches)
