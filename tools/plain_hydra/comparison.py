"""Comparison of the cells that plain Hydra and the runner make of one line."""

from collections import Counter
from collections.abc import Sequence

from tools.plain_hydra.cells import of_hydra, of_runner
from tools.plain_hydra.lines import drawn, written
from tools.plain_hydra.meant import reason_for

OUTCOMES = ("same", "both refuse", "different", "runner refuses", "Hydra refuses")
_RANDOM = 1000
_COMPOSED = 3


def main() -> bool:
    """Compare all lines and print those that differ; return whether each difference is meant."""
    passed = True
    for name, lines in (("written", written()), ("random", drawn(_RANDOM, 1))):
        outcomes: Counter[str] = Counter()
        reasons: Counter[str] = Counter()
        for line in lines:
            outcome, difference = compare(line)
            outcomes[outcome] += 1
            if outcome not in OUTCOMES[:2]:
                reason = reason_for(line)
                reasons[reason or "NOT MEANT"] += 1
                if not reason:
                    passed = False
                    print(f"  NOT MEANT, {outcome}: {' '.join(line)}\n    {difference}", flush=True)
        print(f"{name}: {len(lines)} lines: " + ", ".join(f"{outcomes[each]} {each}" for each in OUTCOMES))
        for reason, count in reasons.most_common():
            print(f"  {count:4}  {reason}")
    return passed


def compare(line: Sequence[str], composed: int = _COMPOSED) -> tuple[str, str]:
    """Return the outcome of a line, one of OUTCOMES, and the first difference or refusal.

    Args:
        line: The overrides.
        composed: Number of cells to compose, of the last, the middle and the first one; all cells are counted.
    """

    def few(count: int) -> list[int]:
        return sorted({0, count // 2, count - 1} & {*range(count)})[-composed:]

    ours, theirs = of_runner(line, few), of_hydra(line, few)
    if isinstance(ours, str) or isinstance(theirs, str):
        refused = isinstance(ours, str), isinstance(theirs, str)
        outcome = {(True, True): "both refuse", (True, False): "runner refuses"}.get(refused, "Hydra refuses")
        return outcome, ours if isinstance(ours, str) else str(theirs)
    if ours[0] != theirs[0]:
        return "different", f"{ours[0]} cells, not {theirs[0]}"
    for number, (one, other) in enumerate(zip(ours[1], theirs[1], strict=True)):
        if repr(one) != repr(other):
            keys = [key for key in {**one, **other} if repr(one.get(key)) != repr(other.get(key))]
            return "different", f"composed cell {number}: {[(key, one.get(key), other.get(key)) for key in keys]}"[:500]
    return "same", ""
