"""Combinations of two to four changes: balanced, and drawn from a seed. They are described, not tested."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from runner.base.dotted_keys import split_override
from runner.sweeps.challenge.question import Variation

MOST = 12
"""Number of combinations."""

_SIZES = (2, 3, 4)  # changes of successive combinations
_CLASSES = ("equivalent", "conditions")


@dataclass(frozen=True)
class Combination:
    """Several changes of the asked case at once.

    Attributes:
        labels: What is changed, in words.
        sides: Overrides that each side gets.
        exact: True if neither side draws anything.
        pairs: Number of pairs; 0 if the budget cut it.
        effect: Difference of B from A relative to the scale of the variations; None if a side does not work.
    """

    labels: Sequence[str]
    sides: Sequence[Sequence[str]]
    exact: bool = False
    pairs: int = 0
    effect: float | None = None


def combine(variations: Sequence[Variation], seed: int) -> Iterator[Combination]:
    """Yield combinations of changes of equivalent choices and conditions, each change nearly equally often.

    The changes of a combination are of different families and set different keys.

    Args:
        variations: All variations.
        seed: Seed of the choice.
    """
    rng = np.random.default_rng(seed)
    some = [one for one in variations if one.kind in _CLASSES]
    used = np.zeros(len(some))
    known: set[frozenset[int]] = set()
    for number in range(MOST):
        chosen: list[int] = []
        for place in np.lexsort((rng.random(len(some)), used)).tolist():
            if all(_fit(some[place], some[other]) for other in chosen):
                chosen.append(place)
            if len(chosen) == _SIZES[number % len(_SIZES)]:
                break
        if len(chosen) < min(_SIZES):
            return
        used[chosen] += 1.0
        if frozenset(chosen) in known:  # of few variations there are fewer combinations
            continue
        known.add(frozenset(chosen))
        parts = [some[place] for place in sorted(chosen)]
        yield Combination(
            [part.label for part in parts],
            [list(chain(*texts)) for texts in zip(*(part.sides for part in parts), strict=True)],
        )


def _fit(one: Variation, other: Variation) -> bool:
    return one.family != other.family and not _keys(one) & _keys(other)


def _keys(one: Variation) -> set[str]:
    return {split_override(text)[0] for text in chain(*one.sides)}
