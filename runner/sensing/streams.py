"""Random streams of many runs, identical to `np.random.default_rng([seed, repetition, place])`.

The streams agree to the last bit. NumPy hashes such numbers to the state of its generator (O'Neill's seed_seq without
bias, and PCG64). NEP 19 and the NumPy documentation keep this algorithm fixed. This module hashes the numbers of all
runs at once and sets one generator to each state in turn. This takes a fifth of the time of a new generator for each
run.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint32]

MISMATCH, JOINT_TORQUES, TIP, COMPUTATION = 2**32 - 1, 2**32 - 2, 2**32 - 3, 2**32 - 4
"""Places of these draws in `[seed, repetition, place]`; the places of control loops and wrist sensor count from 0."""

_POOL = 4  # words of 32 bits
_INIT_A, _MULT_A = 0x43B0D7E5, 0x931E8875
_INIT_B, _MULT_B = 0x8B51F9DD, 0x58F38DED
_MIX_LEFT, _MIX_RIGHT = np.uint32(0xCA01F9DD), np.uint32(0x4973F715)
_HALF = np.uint32(16)
_PCG_MULTIPLIER = 0x2360ED051FC65DA44385DF649FCCF645
_BITS_32, _BITS_128 = 2**32 - 1, 2**128 - 1


def generators(numbers: Sequence[Sequence[int]]) -> Iterator[np.random.Generator]:
    """Yield a generator for each list of whole numbers from 0, all lists as long, equal to `default_rng` of the list.

    It is one generator, set anew each time: what it is to draw must be drawn before the next is asked for.
    """
    stream = np.random.PCG64(0)
    generator = np.random.Generator(stream)
    state = stream.state
    for start, increment in _states(numbers):
        state["state"]["state"], state["state"]["inc"] = start, increment
        stream.state = state
        yield generator


def _states(numbers: Sequence[Sequence[int]]) -> Iterator[tuple[int, int]]:
    """Yield the state of PCG64 that each list of numbers gives: its state and its increment, of 128 bits."""
    for first, second, third, fourth in _seeds(numbers):
        increment = (third << 65 | fourth << 1 | 1) & _BITS_128
        start = (first << 64 | second) + increment
        yield (start * _PCG_MULTIPLIER + increment) & _BITS_128, increment


def _seeds(numbers: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the four words of 64 bits that each list of numbers is hashed to."""
    entropies = [[word for number in own for word in _words(number)] for own in numbers]
    lengths = np.array([len(entropy) for entropy in entropies])
    seeds = np.empty((len(entropies), _POOL), dtype=np.uint64)
    for length in np.unique(lengths):
        own = np.flatnonzero(lengths == length)
        seeds[own] = _hashed(np.array([entropies[run] for run in own], dtype=np.uint32).T)
    return seeds.tolist()


def _words(number: int) -> list[int]:
    """Return a whole number's digits to the base 2^32, the lowest first."""
    if number <= _BITS_32:
        return [number]
    return [number & _BITS_32, *_words(number >> 32)]


def _hashed(entropy: Words) -> NDArray[np.uint64]:
    """Return what SeedSequence makes of entropy, shape (words, runs): its state, four words of 64 bits, (runs, 4)."""
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
