"""CPU time and memory of a repetition among many: 10^5 of one run against 10^3 of it, noise and metrics included.

Blocks of repetitions keep the time of each the same, and the memory that of only its metrics. Nominal models that are
drawn in each repetition (mismatch=sampled) cost at most half of the time without them.
"""

import resource
import time

from runner.assembly.run_cost import memory_of_run
from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.simulation.run import simulate_blocks

_FEW, _MANY = 1_000, 100_000
_BRIEF = 5_000  # instead of _MANY
_TIMES = 5  # that the few are made; the quickest counts
_TARGET = 1.25
_DRAWN, _TARGET_DRAWN = 10_000, 1.5
_OVERRIDES = ("robot=macro", "plant=rk4", "trajectory=quintic", "noise=thesis", "torque_limits=thesis")


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: Number of times that the few are made, None for _TIMES; 1 also makes fewer of the many.
    """
    most, some = (_BRIEF, _FEW) if rounds == 1 else (_MANY, _DRAWN)
    few = min(_seconds(_FEW) for _ in range(rounds or _TIMES))
    before = _peak()
    many = _seconds(most)
    ratio, taken, allowed = many / few, _peak() - before, _memory(most) - _memory(_FEW)
    met = ratio <= _TARGET and taken <= allowed
    print(f"CPU time of a repetition of {' '.join(_OVERRIDES)}, on 2 threads")
    print(
        f"  {_FEW} repetitions {1e6 * few:.0f} us, {most} {1e6 * many:.0f} us: {ratio:.2f}  target {_TARGET:g}"
        f"\n  {1e-6 * taken:.0f} MB more; limits.memory counts {1e-6 * allowed:.0f}: {'met' if met else 'MISSED'}"
    )
    plain, drawn = (_seconds(some, f"mismatch={name}") for name in ("none", "sampled"))
    cheap = drawn / plain <= _TARGET_DRAWN
    print(
        f"  {some} with mismatch=none {1e6 * plain:.0f} us, with sampled {1e6 * drawn:.0f} us: {drawn / plain:.2f}  "
        f"target {_TARGET_DRAWN:g}: {'met' if cheap else 'MISSED'}"
    )
    return met and cheap


def _seconds(repetitions: int, *more: str) -> float:
    """Return the CPU time of a repetition, in s."""
    config = validate(compose([*_OVERRIDES, *more, f"repetitions={repetitions}"]))
    start = time.process_time()
    simulate_blocks(config, threads=2)
    return (time.process_time() - start) / repetitions


def _memory(repetitions: int) -> float:
    """Return the number of bytes that `limits.memory` counts."""
    config = validate(compose([*_OVERRIDES, f"repetitions={repetitions}"]))
    return memory_of_run(config.arm, config.timing.ticks, repetitions, config.has_contact)


def _peak() -> float:
    """Return the largest memory that this process has had, in bytes."""
    return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
