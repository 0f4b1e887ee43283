"""Messages of a comparison: sizes of both sweeps, matched and unmatched cells, and limits of what is shown."""

from collections.abc import Iterator, Mapping, Sequence

from runner.reporting.comparison.cells import label_text
from runner.reporting.comparison.operand import Side
from runner.reporting.comparison.sweeps import SweepComparison

NOISE_ALONE = (
    "Repetitions differ in their noise draws alone (mismatch.spread is 0): the intervals tell what other draws would "
    "do, not what another arm or another error of the model would."
)

POOLED = (
    "Over all cells each draw counts once, by the mean of its cells. If the difference is above zero in some cells and "
    "below in others, that number describes none of them."
)
_NAMED = 3  # cells of one sweep alone


def format_count(count: int, one: str, many: str) -> str:
    """Return a number with what is counted, such as "1 cell is" or "2 cells are"."""
    return f"{count} {one if count == 1 else many}"


def size_told(side: Side) -> str:
    """Return how many cells a sweep has, and repetitions in each."""
    failed = f", {side.failed} of them failed" if side.failed else ""
    cells = format_count(len(side.measurements.hashes), "cell", "cells")
    return f"{cells}{failed}; repetitions in each: {side.measurements.repetitions}"


def cells_told(found: SweepComparison) -> Iterator[str]:
    """Yield which cells are compared, and which are not and why."""
    matched = found.matched
    by = f", matched by {', '.join(matched.keys)}" if matched.keys else ""
    repetitions = min(side.measurements.repetitions for side in (found.a, found.b))
    both = format_count(len(matched.labels), "cell is", "cells are")
    yield (f"{both} in both{by}; up to {repetitions} repetitions of each are compared")
    if matched.other_seeds:
        more = format_count(matched.other_seeds, "more cell is", "more cells are")
        yield f"{more} in both with different seeds, and not compared"
    for side, alone in zip((found.a, found.b), matched.alone, strict=True):
        if alone:
            yield (f"{format_count(len(alone), 'cell is', 'cells are')} in {side.name} alone: {_some(alone)}")
        if side.missing:
            left = format_count(side.missing, "cell", "cells")
            yield (f"{left} of {side.name} not stored; continue with: {side.command}")
        if side.failed:
            failed = format_count(side.failed, "cell", "cells")
            yield f"{failed} of {side.name} failed; a failed repetition counts as beyond every number"


def _some(labels: Sequence[Mapping[str, str]]) -> str:
    more = f"; and {len(labels) - _NAMED} more" if len(labels) > _NAMED else ""
    return "; ".join(map(label_text, labels[:_NAMED])) + more
