"""Patterns of run names, such as "turns/{preset}/goal", with their runs and levels.

`{axis=a|b}` matches only these levels, in this order.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from runner.base.errors import RunnerError, nearest
from runner.reporting.words import in_words
from runner.store import Run
from runner.study.job import Results

_BRACES = re.compile(r"\{(\w+)(?:=([^{}]+))?\}")
_WHOLE = re.compile(r"^(-?\d+)\.0$")
_MOST_AXES = 3  # between two slashes: with many, a long name may be taken apart in too many ways


@dataclass(frozen=True)
class Found:
    """A run that a pattern stands for.

    Attributes:
        name: Its name.
        run: The run.
        levels: The level of each axis that the pattern names.
    """

    name: str
    run: Run
    levels: Mapping[str, str]


def axes_of(pattern: str) -> tuple[str, ...]:
    """Return the axes that a pattern names, in order."""
    return tuple(axis for axis, _ in _BRACES.findall(pattern))


def found(runs: Mapping[str, Run], pattern: str, by: Sequence[str] = ()) -> list[Found]:
    """Return the runs that a pattern stands for, sorted by levels, each axis in the order of the plan.

    Args:
        runs: The runs of a study by name, in the order of its plan.
        pattern: A run's name in which an axis in braces stands for any of its levels.
        by: Axes from the outermost to the innermost loop; the others follow in the pattern's order.

    Raises:
        RunnerError: if it stands for none, or `by` names another axis.
        MissingError: if one of them was not made.
    """
    axes = axes_of(pattern)
    for axis in by:
        if axis not in axes:
            raise RunnerError(f"the pattern {pattern} has no axis '{axis}'{nearest(axis, axes)}")
    names = [*runs, *(runs.missing if isinstance(runs, Results) else ())]
    levels = dict(_matches(names, pattern))
    if not levels:
        raise RunnerError(f"no run is named like '{pattern}'{nearest(pattern, names)}")
    order = [*by, *(axis for axis in axes if axis not in by)]
    chosen = {axis: own.split("|") for axis, own in _BRACES.findall(pattern) if own}
    ranks = {
        axis: list(dict.fromkeys([*chosen.get(axis, ()), *(own[axis] for own in levels.values())])) for axis in order
    }
    ranked = sorted(levels, key=lambda name: [ranks[axis].index(levels[name][axis]) for axis in order])
    return [Found(name, runs[name], levels[name]) for name in ranked]


def other(runs: Mapping[str, Run], pattern: str, levels: Mapping[str, str]) -> Run:
    """Return the run whose name is a pattern with levels put in.

    Raises:
        RunnerError: if the pattern names an axis that has no level here, or there is no such run.
    """
    return runs[filled_in(pattern, levels)]


def filled_in(pattern: str, levels: Mapping[str, str]) -> str:
    """Return a string with the axes in braces replaced by levels.

    Raises:
        RunnerError: if it names an axis that has no level here.
    """
    for axis in axes_of(pattern):
        if axis not in levels:
            raise RunnerError(f"'{pattern}': no axis '{axis}'{nearest(axis, levels)}; axes: {', '.join(levels)}")
    return _BRACES.sub(lambda brace: levels[brace[1]], pattern)


def called(text: str, levels: Mapping[str, str], words: Mapping[str, str]) -> str:
    """Return a string with the axes in braces replaced by words for levels, whole numbers without decimals."""
    whole = {axis: _WHOLE.sub(r"\1", level) for axis, level in levels.items()}
    return filled_in(text, {axis: words.get(level, in_words(whole[axis])) for axis, level in levels.items()})


def _matches(names: Iterable[str], pattern: str) -> Iterator[tuple[str, dict[str, str]]]:
    if (most := max(part.count("{") for part in _BRACES.sub("{", pattern).split("/"))) > _MOST_AXES:
        raise RunnerError(f"'{pattern}': {most} axes between two slashes; allowed: up to {_MOST_AXES}")
    expression, end = "", 0
    for brace in _BRACES.finditer(pattern):
        axis, chosen = brace.groups()
        first = f"(?P<{axis}>" not in expression
        levels = "|".join(map(re.escape, chosen.split("|"))) if chosen else "[^/]+"
        expression += re.escape(pattern[end : brace.start()]) + (f"(?P<{axis}>{levels})" if first else f"(?P={axis})")
        end = brace.end()
    for name in names:
        if match := re.fullmatch(expression + re.escape(pattern[end:]), name):
            yield name, match.groupdict()
