"""Resolved config values that are not the same in all cells of a sweep, beyond what was swept.

Where `robot` is swept, the gains, the path and the encoders' noise may go with it, as a robot's file proposes them;
what the arms seem to do may be done by these.
"""

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from runner.store import simulated_part

if TYPE_CHECKING:
    from runner.sweeps.measurements import Axis

_NAMES = ("kind", "name")  # of the option that an axis chooses
# Of a robot: what acts by itself. All else is the arm, or what it proposes to other groups, where it is found.
_OF_A_ROBOT = ("payload", "settling_band", "tool")
_MOST_TOGETHER = 3  # axes that a value is looked for to follow
_NAMED = 4


@dataclass(frozen=True)
class Difference:
    """A value that differs between cells and was not swept.

    Attributes:
        key: Its dotted key, or what it is in words.
        axes: Names of the axes that it follows; empty where it follows none.
        values: Each value as text, with the levels of these axes at which it stands, such as ("macro, mini", "0.01").
    """

    key: str
    axes: tuple[str, ...]
    values: Sequence[tuple[str, str]]


class Resolved:
    """The resolved configs of a sweep, of which is kept what differs between them."""

    def __init__(self) -> None:
        self._first: Mapping[str, Any] = {}
        self._cells = 0
        self._given: set[str] = set()
        self._codes: dict[str, list[int]] = {}  # number of each cell's text, of those keys that differ so far
        self._texts: dict[str, dict[str | None, int]] = {}  # numbers of a key's texts, from that of the first cell on

    def add(self, config: Mapping[str, Any], overrides: Sequence[str] = ()) -> None:
        """Take the config of the next cell; keys that say where and how a run is made are left out.

        Args:
            config: Its resolved config.
            overrides: What gave it: the keys of these are axes, or the same in all cells, and take no memory (but for
                those that hold other keys' values).
        """
        part = simulated_part(config)
        self._given.update(text.lstrip("+").partition("=")[0] for text in overrides if "${" not in text)
        self._first = self._first or part
        # Most groups are the same in all cells, and are not looked at.
        changed = [name for name in {**self._first, **part} if self._first.get(name) != part.get(name)]
        before, now = (_flat({name: some[name] for name in changed if name in some}) for some in (self._first, part))
        for key in dict.fromkeys([*before, *now]):
            if key in self._given:
                continue
            if key in self._codes or before.get(key) != now.get(key):
                texts = self._texts.setdefault(key, {before.get(key): 0})
                codes = self._codes.setdefault(key, [])
                codes.extend([0] * (self._cells - len(codes)))
                codes.append(texts.setdefault(now.get(key), len(texts)))
        self._cells += 1

    def differences(self, axes: Sequence["Axis"]) -> list[Difference]:
        """Return what differs beyond the axes, in the order in which cells show it."""
        found = []
        for key, some in self._codes.items():
            if key in self._given:
                continue
            texts = list(self._texts[key])
            codes = np.array(some + [0] * (self._cells - len(some)), dtype=np.intp)
            group = key.partition(".")[0]
            of_option = any(axis.name == group != key for axis in axes)
            if any(key == axis.name or (key.startswith(f"{axis.name}.") and axis.name != group) for axis in axes):
                continue
            if of_option and _is_option(key):
                continue
            # What one option has and another has not is what they are.
            present = codes != texts.index(None) if of_option and None in texts else np.ones(len(codes), dtype=bool)
            if np.unique(codes[present]).size > 1:
                found.append(_difference(key, codes, texts, present, axes))
        return found


def differing(configs: Iterable[Mapping[str, Any]], axes: Sequence["Axis"]) -> list[Difference]:
    """Return the resolved values that differ between the cells of a sweep beyond its axes.

    Left out are the axes themselves; of a group that is swept, such as `robot`, its name and kind, what only some of
    its options have, and what an arm is made of.

    Args:
        configs: The resolved config of each cell.
        axes: What was swept.
    """
    resolved = Resolved()
    for config in configs:
        resolved.add(config)
    return resolved.differences(axes)


def in_words(differences: Sequence[Difference]) -> str:
    """Return in a line that values differ, and the first of them; empty where none does."""
    if not differences:
        return ""
    count, named = len(differences), [difference.key for difference in differences[:_NAMED]]
    more = f" and {count - len(named)} more" if count > len(named) else ""
    axes = list(dict.fromkeys(name for difference in differences for name in difference.axes))
    by = f" with {', '.join(axes)}" if axes else ""
    values = "1 config value differs" if count == 1 else f"{count} config values differ"
    return f"{values} beyond the swept axes{by}: {', '.join(named)}{more}"


def _is_option(key: str) -> bool:
    """Return whether a key of a swept group says which option it is, or what is no part of the comparison."""
    group, _, rest = key.partition(".")
    return rest in _NAMES or (group == "robot" and rest.partition(".")[0] not in _OF_A_ROBOT)


def _difference(
    key: str, codes: NDArray[np.intp], texts: Sequence[str | None], present: NDArray[np.bool_], axes: Sequence["Axis"]
) -> Difference:
    for count in range(1, min(len(axes), _MOST_TOGETHER) + 1):
        for some in itertools.combinations(axes, count):
            pairs = np.unique(np.column_stack([*(axis.level for axis in some), codes])[present], axis=0)
            if len(np.unique(pairs[:, :-1], axis=0)) == len(pairs):
                levels: dict[str, list[str]] = {}
                for *places, code in pairs.tolist():
                    name = " and ".join(_name(axis, place) for axis, place in zip(some, places, strict=True))
                    levels.setdefault(texts[code] or "–", []).append(name)
                values = [(", ".join(names), text) for text, names in levels.items()]
                return Difference(key, tuple(axis.name for axis in some), values)
    return Difference(key, (), [("", texts[code] or "–") for code in np.unique(codes[present]).tolist()])


def _name(axis: "Axis", level: int) -> str:
    value = axis.values[level]
    return value if isinstance(value, str) else f"{value:g}"


def _flat(config: Mapping[str, Any]) -> dict[str, str]:
    return dict(_entries(config, ""))


def _entries(config: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, str]]:
    for key, value in config.items():
        if isinstance(value, Mapping) and value:
            yield from _entries(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", _text(value)


def _text(value: Any) -> str:
    """Return a value as text: equal numbers alike, whether they are written 1 or 1.0."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"{value:.12g}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"[{', '.join(map(_text, value))}]"
    return str(value)
