"""`python -m tools.fuzz.expressions [N] [--seed S] [--only N]`: random expressions of a file, half of them hostile.

Each has a value or is refused with a message; none runs code, opens a file or takes 0.1 s of CPU time, nor 50 MB.
Memory is only measured in every fiftieth because that takes four times as long.
"""

import argparse
import sys
import time
import tracemalloc
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests"))
from support.hostile_expressions import attempt, expression

from runner.base.engines import quiet_environment

SECONDS, MEGABYTES = 0.1, 50.0
_WEIGHED = 50
_SHOWN = 20


def main(arguments: list[str] | None = None) -> bool:
    """Try expressions; print how they ended, the slowest and the largest, and return whether nothing was found."""
    parser = argparse.ArgumentParser(prog="python -m tools.fuzz.expressions", description=__doc__)
    parser.add_argument("count", nargs="?", type=int, default=1_000_000, metavar="N")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, metavar="N", help="try and show only expression N")
    options = parser.parse_args(arguments or [])
    numbers = range(options.count) if options.only is None else [options.only]
    bad: dict[int, list[str]] = {}
    ends: Counter[str] = Counter()
    slowest, largest = (0.0, 0), (0.0, 0)
    for number in numbers:
        text = expression(options.seed, number)
        start = time.process_time()
        ended = attempt(text)
        seconds = time.process_time() - start
        megabytes = _megabytes(text) if number % _WEIGHED < 2 or options.only is not None else 0.0
        slowest, largest = max(slowest, (seconds, number)), max(largest, (megabytes, number))
        ends["refused" if ended.refused else "with a value"] += 1
        over = [f"{seconds:.3f} s"] * (seconds > SECONDS) + [f"{megabytes:.0f} MB"] * (megabytes > MEGABYTES)
        if ended.faults or over:
            bad[number] = [*ended.faults, *over]
    counts = ", ".join(f"{count} {end}" for end, count in ends.items())
    print(f"{len(numbers)} expressions, seed {options.seed}: {counts}; {len(bad)} with faults")
    print(f"  slowest: {slowest[0]:.3f} s (number {slowest[1]}); largest: {largest[0]:.1f} MB (number {largest[1]})")
    for number in list(bad)[:_SHOWN] if options.only is None else numbers:
        print(f"  {number}: {'; '.join(bad.get(number, []))} {expression(options.seed, number)!r:.200}")
    return not bad


def _megabytes(text: str) -> float:
    tracemalloc.start()
    try:
        attempt(text)
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()


if __name__ == "__main__":
    quiet_environment()
    sys.exit(0 if main(sys.argv[1:]) else 1)
