"""Cases of several options: pairwise covers for each session, all the other cases for the slow ones."""

import itertools
from collections.abc import Hashable, Iterable, Sequence
from typing import Any

import pytest

Options = dict[str, Sequence[Hashable]]
Case = dict[str, Any]
Choice = tuple[str, Hashable]

SWITCH = (False, True)


def every_case(options: Options) -> list[Case]:
    """Return the full product of the options."""
    return [dict(zip(options, values, strict=True)) for values in itertools.product(*options.values())]


def pairwise(options: Options) -> list[Case]:
    """Return few cases in which each value of an option meets each value of every other option.

    Greedy: a case starts with a pair that is missing and takes for each further option the value that adds most
    pairs to the case, and of those the one that has most pairs left.
    """
    missing = dict.fromkeys(  # in a fixed order, unlike a set
        frozenset(pair)
        for one, other in itertools.combinations(options, 2)
        for pair in itertools.product(_choices(options, one), _choices(options, other))
    )
    cases = []
    while missing:
        case = dict(next(iter(missing)))
        for name in options:
            if name not in case:
                case[name] = _best(_choices(options, name), set(case.items()), missing)
        cases.append({name: case[name] for name in options})
        for pair in itertools.combinations(case.items(), 2):
            missing.pop(frozenset(pair), None)
    return cases


def _best(choices: list[Choice], taken: set[Choice], missing: Iterable[frozenset[Choice]]) -> Hashable:
    left = {choice: [other for pair in missing if choice in pair for other in pair - {choice}] for choice in choices}
    return max(choices, key=lambda choice: (len(taken.intersection(left[choice])), len(left[choice])))[1]


def covered(options: Options) -> list[Any]:
    """Return all cases as parameters of a test with their names; those beyond a pairwise cover are slow."""
    few = pairwise(options)
    return [
        pytest.param(case, id=name_of(case), marks=() if case in few else pytest.mark.slow)
        for case in every_case(options)
    ]


def name_of(case: Case) -> str:
    """Name a case by the switches that are on and by the values of its other options."""
    on = [name if value is True else str(value) for name, value in case.items() if value is not False]
    return "-".join(on) or "none"


def _choices(options: Options, name: str) -> list[Choice]:
    return [(name, value) for value in options[name]]
