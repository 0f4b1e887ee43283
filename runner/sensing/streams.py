"""Random streams of many runs, identical to `np.random.default_rng([seed, repetition, place])`.

The streams are bitwise equal. NumPy hashes such numbers to the state of its generator (O'Neill's seed_seq without bias,
and PCG64). NEP 19 and the NumPy documentation guarantee this algorithm. This module hashes the numbers of all runs
together and sets one generator to each state in turn. This takes one fifth of the time of a new generator for each run.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint32]

MISMATCH, JOINT_TORQUES, TIP, COMPUTATION = 2**32 - 1, 2**32 - 2, 2**32 - 3, 2**32 - 4
ENVIRONMENT, ROUNDING = 2**32 - 5, 2**32 - 6
"""Values of `place` for these random streams; control loops and the wrist sensor have the values from 0."""

_POOL = 4  # words of 32 bits
_INIT_A, _MULT_A = 0x43B0D7E5, 0x931E8875
_INIT_B, _MULT_B = 0x8B51F9DD, 0x58F38DED
_MIX_LEFT, _MIX_RIGHT = np.uint32(0xCA01F9DD), np.uint32(0x4973F715)
_HALF = np.uint32(16)
_PCG_MULTIPLIER = 0x2360ED051FC65DA44385DF649FCCF645
_BITS_32, _BITS_128 = 2**32 - 1, 2**128 - 1


def generators(numbers: Sequence[Sequence[int]]) -> Iterator[np.random.Generator]:
    """Yield a generator for each list of non-negative integers, equal to `default_rng` of the list.

    All lists must have the same length. The generator is the same object each time: draw from it before the next step.
    """
    stream = np.random.PCG64(0)
    generator = np.random.Generator(stream)
    state = stream.state
    for start, increment in _states(numbers):
        state["state"]["state"], state["state"]["inc"] = start, increment
        stream.state = state
        yield generator


def _states(numbers: Sequence[Sequence[int]]) -> Iterator[tuple[int, int]]:
    """Yield the state and the increment of PCG64, of 128 bits each, for each list of numbers."""
    for first, second, third, fourth in _seeds(numbers):
        increment = (third << 65 | fourth << 1 | 1) & _BITS_128
        start = (first << 64 | second) + increment
        yield (start * _PCG_MULTIPLIER + increment) & _BITS_128, increment


def _seeds(numbers: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the hash of each list of numbers, four words of 64 bits."""
    entropies = [[word for number in own for word in _words(number)] for own in numbers]
    lengths = np.array([len(entropy) for entropy in entropies])
    seeds = np.empty((len(entropies), _POOL), dtype=np.uint64)
    for length in sorted(set(lengths.tolist())):
        own = np.flatnonzero(lengths == length)
        seeds[own] = _hashed(np.array([entropies[run] for run in own], dtype=np.uint32).T)
    return seeds.tolist()


def _words(number: int) -> list[int]:
    """Return the digits of an integer to the base 2^32, the lowest first."""
    if number <= _BITS_32:
        return [number]
    return [number & _BITS_32, *_words(number >> 32)]


def _hashed(entropy: Words) -> NDArray[np.uint64]:
    """Return the state of SeedSequence, four words of 64 bits, shape (runs, 4), from entropy, shape (words, runs)."""
    hashing = _Hashing(_INIT_A, _MULT_A)
    pool = [hashing.mix(entropy[i] if i < len(entropy) else np.zeros_like(entropy[0])) for i in range(_POOL)]
    for source in range(_POOL):
        for target in range(_POOL):
            if source != target:
                pool[target] = _mixed(pool[target], hashing.mix(pool[source]))
    for more in entropy[_POOL:]:
        pool = [_mixed(word, hashing.mix(more)) for word in pool]
    hashing = _Hashing(_INIT_B, _MULT_B)
    halves = [hashing.mix(pool[i % _POOL]).astype(np.uint64) for i in range(2 * _POOL)]
    return np.stack([low | high << np.uint64(32) for low, high in zip(halves[::2], halves[1::2], strict=True)], axis=1)


class _Hashing:
    """Multiplication by a constant that changes with each use."""

    def __init__(self, start: int, factor: int) -> None:
        self._constant, self._factor = start, factor

    def mix(self, value: Words) -> Words:
        """Return the next hash of each word."""
        mixed: Words = value ^ np.uint32(self._constant)
        self._constant = self._constant * self._factor & _BITS_32
        mixed *= np.uint32(self._constant)
        mixed ^= mixed >> _HALF
        return mixed


def _mixed(one: Words, other: Words) -> Words:
    mixed: Words = _MIX_LEFT * one
    mixed -= _MIX_RIGHT * other
    mixed ^= mixed >> _HALF
    return mixed
