"""Stored results of a study by name, and the runs that a pattern such as "turns/{preset}/goal" stands for.

Each part of a name between two slashes is a word or the level of an axis of the plan. In a pattern, `{axis}` stands for
every level of an axis, and `{axis=a|b}` for these, in this order. An axis is called by its key, as
`{robot.payload.mass}`, or by its end, as `{mass}`.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from runner.base.errors import RunnerError, nearest
from runner.reporting.words import in_words
from runner.store import Calibration, Run

Parts = tuple[tuple[str, str], ...]
"""The parts of a run's name: of each, the axis whose level it is, empty for a word, and its text."""
Thing = TypeVar("Thing")
Stored = TypeVar("Stored", Run, Calibration)

_BRACES = re.compile(r"\{([\w.]+)(?:=([^{}]+))?\}")
_PART = re.compile(r"(?:\{[^{}]*\}|[^/{}])+")
_WHOLE = re.compile(r"^(-?\d+)\.0$")


class MissingError(RunnerError):
    """A run or calibration that a report needs, and that was not made."""


class LeftOutError(MissingError):
    """A run or calibration that the profile leaves out."""


class Results(dict[str, Thing]):
    """The runs or calibrations of a study by name; asking for one that was not made raises MissingError.

    One that is not of the study is refused with the nearest name, so that no condition is left without its runs.

    Args:
        found: Those that were made.
        missing: Why the others were not, by name.
        dropped: Why others again were not asked for, by name.
        parts: The parts of each name, of these others as well; those that patterns are to find.
    """

    def __init__(
        self,
        found: Mapping[str, Thing],
        missing: Mapping[str, str] | None = None,
        dropped: Mapping[str, str] | None = None,
        parts: Mapping[str, Parts] | None = None,
    ) -> None:
        super().__init__(found)
        self.missing = dict(missing or {})
        self.dropped = dict(dropped or {})
        self.parts = dict(parts or {})
        self._levels: dict[tuple[str, str], list[str]] = {}
        self._named: dict[tuple[int, int, str], dict[str, None]] = {}
        for name, own in self.parts.items():
            for place, (_, text) in enumerate(own):
                self._named.setdefault((len(own), place, text), {})[name] = None
        self.read: set[str] = set()
        """Names of those that were read."""
        self.derived: dict[object, Any] = {}
        """Values that a study computes from all results, by the keys that it chooses."""

    def levels(self, word: str, axis: str) -> list[str]:
        """Return the levels of an axis in the names that begin with a word, of what was asked for."""
        if (word, axis) not in self._levels:
            names = (parts for name, parts in self.parts.items() if name in self or name in self.missing)
            own = (level for (_, first), *rest in names if first == word for key, level in rest if _is_axis(axis, key))
            self._levels[word, axis] = list(dict.fromkeys(own))
        return self._levels[word, axis]

    def with_words(self, wanted: Parts) -> list[str]:
        """Return the names that have the words of a pattern in their places, in the order of the plan."""
        words = [(len(wanted), place, text) for place, (axis, text) in enumerate(wanted) if not axis]
        named: list[Mapping[str, object]] = [self._named.get(word, {}) for word in words] or [self.parts]
        rarest, *others = sorted(named, key=len)
        return [name for name in rarest if all(name in other for other in others)]

    def __getitem__(self, name: str) -> Thing:
        self.read.add(name)
        return super().__getitem__(name)

    def __missing__(self, name: str) -> Thing:
        if name in self.missing:
            raise MissingError(f"{name}: {self.missing[name]}")
        if name in self.dropped:
            raise LeftOutError(f"{name}: {self.dropped[name]}")
        raise RunnerError(f"the study has no run or calibration '{name}'{nearest(name, [*self, *self.missing])}")


Runs = Results[Run]


def distinct(named: Mapping[str, Stored]) -> list[Stored]:
    """Return runs or calibrations, each once: one may have several names. Reports count these."""
    return list({each.hash: each for each in named.values()}.values())


def name_of(parts: Parts) -> str:
    """Return the name of a run from its parts."""
    return "/".join(text for _, text in parts)


def parts_of(pattern: str, levels: Mapping[str, object]) -> Parts:
    """Return the parts of the name that a pattern stands for with a level of each of its axes."""
    return tuple((axis, str(levels[axis]) if axis else text) for axis, text in _parsed(pattern))


@dataclass(frozen=True)
class MatchedRun:
    """A run that a pattern stands for.

    Attributes:
        name: Its name.
        run: The run.
        levels: The level of each axis that the pattern names.
    """

    name: str
    run: Run
    levels: Mapping[str, str]


def axes_of(text: str) -> tuple[str, ...]:
    """Return the axes that a pattern or another string names in braces, in order."""
    return tuple(axis for axis, _ in _BRACES.findall(text))


def matching_runs(runs: Runs, pattern: str, by: Sequence[str] = ()) -> list[MatchedRun]:
    """Return the runs that a pattern stands for, sorted by levels, each axis in the order of the plan.

    Args:
        runs: The runs of a study.
        pattern: A run's name in which an axis in braces stands for any of its levels.
        by: Axes from the outermost to the innermost loop; the others follow in the pattern's order.

    Raises:
        RunnerError: if it stands for none, it names an axis or a level that there is not, or `by` another axis.
        MissingError: if one of them was not made, or the profile leaves all of them out.
    """
    wanted, axes = _parsed(pattern), axes_of(pattern)
    for axis in by:
        if axis not in axes:
            raise RunnerError(f"the pattern {pattern} has no axis '{axis}'{nearest(axis, axes)}")
    if not axes:
        return [MatchedRun(pattern, runs[pattern], {})]
    alike = {name: own for name in runs.with_words(wanted) if (own := _levels(wanted, runs.parts[name]))}
    if not alike:
        raise RunnerError(_unlike(runs, pattern, wanted))
    chosen = {axis: text.split("|") for axis, text in wanted if axis and text}
    for axis, those in chosen.items():
        there = [*dict.fromkeys(each[axis] for each in alike.values())]
        for level in (level for level in those if level not in there):
            known = f"{nearest(level, there)}; levels: {', '.join(there)}"
            raise RunnerError(f"'{pattern}': axis '{axis}' has no level '{level}'{known}")
    levels = {name: each for name, each in alike.items() if all(each[axis] in chosen[axis] for axis in chosen)}
    asked = [name for name in levels if name in runs or name in runs.missing] or [*levels]
    order = [*by, *(axis for axis in axes if axis not in by)]
    ranks = {axis: chosen.get(axis) or [*dict.fromkeys(levels[name][axis] for name in asked)] for axis in order}
    asked.sort(key=lambda name: [ranks[axis].index(levels[name][axis]) for axis in order])
    return [MatchedRun(name, runs[name], levels[name]) for name in asked]


def other(runs: Mapping[str, Run], pattern: str, levels: Mapping[str, str]) -> Run:
    """Return the run whose name is a pattern with levels put in.

    Raises:
        RunnerError: if the pattern names an axis that has no level here, or there is no such run.
    """
    return runs[_filled_in(pattern, levels)]


def called(text: str, levels: Mapping[str, str], words: Mapping[str, str]) -> str:
    """Return a string with the axes in braces replaced by words for levels, whole numbers without decimals."""
    whole = {axis: _WHOLE.sub(r"\1", level) for axis, level in levels.items()}
    return _filled_in(text, {axis: words.get(level, in_words(whole[axis])) for axis, level in levels.items()})


def _filled_in(text: str, levels: Mapping[str, str]) -> str:
    for axis in axes_of(text):
        if axis not in levels:
            raise RunnerError(f"'{text}': no axis '{axis}'{nearest(axis, levels)}; axes: {', '.join(levels)}")
    return _BRACES.sub(lambda brace: levels[brace[1]], text)


def _parsed(pattern: str) -> Parts:
    """Return axis and text of each part: of a word its text, of an axis the levels chosen, empty for all."""
    parts = []
    for part in _PART.findall(pattern):
        brace = _BRACES.fullmatch(part)
        if brace is None and "{" in part:
            raise RunnerError(f"'{pattern}': an axis is a whole part of a name; found '{part}'")
        parts.append((brace[1], brace[2] or "") if brace else ("", part))
    return tuple(parts)


def _is_axis(name: str, key: str) -> bool:
    return f".{key}".endswith(f".{name}")


def _levels(wanted: Parts, parts: Parts) -> dict[str, str]:
    """Return the levels of the axes of a pattern in a name; none if the name has other words or axes."""
    if len(wanted) != len(parts):
        return {}
    levels = {}
    for (axis, text), (key, own) in zip(wanted, parts, strict=True):
        if axis and _is_axis(axis, key):
            levels[axis] = own
        elif axis or text != own:
            return {}
    return levels


def _unlike(runs: Runs, pattern: str, wanted: Parts) -> str:
    """Return why no run is named like a pattern: one of its axes is none of the runs with its words, or its words."""
    alike = [parts for parts in runs.parts.values() if len(parts) == len(wanted) and _has_words(wanted, parts)]
    for (axis, _), *those in zip(wanted, *alike, strict=True) if alike else ():
        keys = list(dict.fromkeys(key for key, _ in those if key))
        if axis and not any(_is_axis(axis, key) for key in keys):
            near = nearest(axis, [key.rpartition(".")[2] for key in keys])
            return f"'{pattern}': no axis '{axis}'{near}; axes: {', '.join(keys) or 'none'}"
    return f"no run is named like '{pattern}'{nearest(pattern, list(runs.parts))}"


def _has_words(wanted: Parts, parts: Parts) -> bool:
    return all(axis or text == own for (axis, text), (_, own) in zip(wanted, parts, strict=True))
