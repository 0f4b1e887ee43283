"""Blocks of code that are timed in turns, so that whatever else the machine does falls on all of them.

Targets are ratios within one round. Work next to it slows Python more than C, by caches, so the quieter half of the
rounds is judged.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median

ROUNDS = 40


@dataclass(frozen=True)
class Block:
    """Work that is timed.

    Attributes:
        work: Does it.
        ticks: Control ticks in it, of all runs together.
    """

    work: Callable[[], object]
    ticks: int


def kept_of(rounds: int) -> str:
    """Return the phrase for the rounds that are judged."""
    return "1 round" if rounds == 1 else f"the quieter {rounds // 2} of {rounds} rounds"


def measure(blocks: Mapping[str, Block], rounds: int = ROUNDS) -> dict[str, list[float]]:
    """Run all blocks in turns; return the CPU time per tick in the quieter half of the rounds, in us."""
    for block in blocks.values():
        block.work()  # caches filled, before anything counts
    found = [{name: _cpu_time(block) for name, block in blocks.items()} for _ in range(rounds)]
    quieter = sorted(found, key=lambda times: sum(times.values()))[: max(1, rounds // 2)]
    return {name: [times[name] for times in quieter] for name in blocks}


def _cpu_time(block: Block) -> float:
    start = time.process_time()
    block.work()
    return (time.process_time() - start) / block.ticks * 1e6


def ratio(ours: list[float], theirs: list[float]) -> float:
    """Return the median over the rounds of one time by another."""
    return median(a / b for a, b in zip(ours, theirs, strict=True))
