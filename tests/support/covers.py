"""Cases of several options: pairwise covers for each session, all the other cases for the slow ones."""

import itertools
from collections.abc import Hashable, Sequence
from typing import Any

import pytest

Options = dict[str, Sequence[Hashable]]
Case = dict[str, Any]

SWITCH = (False, True)


def every_case(options: Options) -> list[Case]:
    """Return the full product of the options."""
    return [dict(zip(options, values, strict=True)) for values in itertools.product(*options.values())]


def pairwise(options: Options) -> list[Case]:
    """Return few cases in which each value of an option meets each value of every other option.

    Greedy: a case starts with a pair that is missing and takes for each further option the value that adds most pairs.
    """
    missing = dict.fromkeys(  # in a fixed order, unlike a set
        frozenset(pair)
        for one, other in itertools.combinations(options, 2)
        for pair in itertools.product(_choices(options, one), _choices(options, other))
    )
    cases = []
    while missing:
        case = dict(sorted(next(iter(missing)), key=lambda choice: list(options).index(choice[0])))
        for name in options:
            if name not in case:
                taken = list(case.items())
                case[name] = max(
                    options[name],
                    key=lambda value: sum(frozenset([(name, value), other]) in missing for other in taken),
                )
        cases.append({name: case[name] for name in options})
        for pair in itertools.combinations(case.items(), 2):
            missing.pop(frozenset(pair), None)
    return cases


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


def _choices(options: Options, name: str) -> list[tuple[str, Hashable]]:
    return [(name, value) for value in options[name]]
