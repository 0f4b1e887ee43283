"""Config differences between two sweeps or runs: the compared values, and other possible causes."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from runner.base.machine import Machine, parts_apart
from runner.reporting.comparison.pairs import Pairs, label_text
from runner.reporting.words import join_values
from runner.store.seal import simulated_part
from runner.sweeps.differing import DISTANCE, entries, is_of_option
from runner.sweeps.measurements import Measurements

# The number of repetitions and their seed do not define a cell.
_OF_REPETITIONS = ("seed", "repetitions")
_OPTION = ("kind", "name")
_NO_PHYSICS = ("seed", "made on", "plant")  # parts of the provenance that do not affect the result
_MACHINE = "machine"
_FOLLOWING = ("plant.step", DISTANCE)  # from other values, which precede them
ABSENT = "(absent)"


@dataclass(frozen=True)
class Value:
    """A value that differs between two sweeps.

    Attributes:
        key: Its dotted key, or a description.
        a: The value in the first, as a string.
        b: The value in the second.
        cells: The matched cells at which it has these two values, as a string; empty for all of them.
    """

    key: str
    a: str
    b: str
    cells: str = ""


@dataclass(frozen=True)
class ConfigDifferences:
    """Differences between the configs of the matched cells of two sweeps.

    Attributes:
        options: Groups with different options, such as `controller`.
        values: Other resolved values that differ.
        provenance: What made the runs, where that differs: commit, versions and machine.
    """

    options: Sequence[Value]
    values: Sequence[Value]
    provenance: Sequence[Value]

    @property
    def names(self) -> list[str]:
        """Names of all differences, each once; options first."""
        return list(dict.fromkeys(value.key for value in (*self.options, *self.values)))

    def question(self, a: str, b: str) -> str:
        """Return the question on the only value that differs, such as "Which controller: joint_pd (A) or pid (B)?".

        It is empty if several values differ, or none.
        """
        first = self.options or self.values
        if len(self.names) != 1 or len(first) != 1:
            return ""
        return f"Which {first[0].key}: {first[0].a} ({a}) or {first[0].b} ({b})?"

    def in_words(self, a: str, b: str) -> str:
        """Return a sentence that names what differs.

        Args:
            a: What the first is called.
            b: What the second is called.
        """
        if not self.names:
            return self._machines_in_words(a, b) or f"{a} and {b} differ in no value."
        first = self.options or self.values
        heads = list(dict.fromkeys(value.key for value in self.options)) or self.names[:1]
        told = ", ".join(f"{key} ({_both(first, key)})" for key in heads)
        rest = [name for name in self.names if name not in heads]
        if len(heads) == 1 and not rest:
            return f"{a} and {b} differ only in {heads[0]}: {_both(first, heads[0])}."
        beside = f", and also in {', '.join(rest)}" if rest else ""
        return f"{a} and {b} differ in {told}{beside}. What follows may be due to any of these."

    def _machines_in_words(self, a: str, b: str) -> str:
        """Return a sentence for equal configs that were simulated on different machines; empty for one machine."""
        machine = next((value for value in self.provenance if value.key == _MACHINE), None)
        others = [value.key for value in self.provenance if value is not machine]
        if machine is None:
            return ""
        apart = f"{machine.a} against {machine.b}"
        if others:
            return f"{a} and {b} differ in no value, but in the machine ({apart}) and in {', '.join(others)}."
        return f"{a} and {b} differ only in the machine: {apart}. What follows may be rounding, which can grow."


def find_differences(pairs: Pairs) -> ConfigDifferences:
    """Return all resolved values that differ between the matched cells of two sweeps.

    If their options of a group differ, only values that both have count, such as gains. Parts of a robot do not count.
    """
    found = _differing(pairs)
    groups = {key.partition(".")[0] for key in found if key.partition(".")[2] in _OPTION}
    options, values = [], []
    for key, texts in found.items():
        group, _, rest = key.partition(".")
        if group not in groups:
            values += _values(key, texts, pairs)
        elif rest in _OPTION:
            if rest == ("name" if f"{group}.name" in found else "kind"):
                options += _values(key, texts, pairs, group)
        elif not is_of_option(key):
            values += _values(key, {both: some for both, some in texts.items() if None not in both}, pairs)
    values.sort(key=lambda value: value.key in _FOLLOWING)
    return ConfigDifferences(options, values, list(_provenance(pairs.a, pairs.b)))


Texts = dict[tuple[str | None, str | None], list[int]]


def _differing(pairs: Pairs) -> dict[str, Texts]:
    """Return the keys that differ, with the values of both sides and the pairs that have these."""
    a, b = pairs.a, pairs.b
    places = np.stack([a.config_of_cells[pairs.of_a], b.config_of_cells[pairs.of_b]], axis=1)
    distinct, which = np.unique(places, axis=0, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    members = np.split(order, np.flatnonzero(np.diff(which.ravel()[order])) + 1)
    found: dict[str, Texts] = {}
    for (of_a, of_b), some in zip(distinct.tolist(), members, strict=True):
        one, other = _part(a, of_a), _part(b, of_b)
        changed = [name for name in {**one, **other} if one.get(name) != other.get(name)]
        flat = [dict(entries({name: config[name] for name in changed if name in config})) for config in (one, other)]
        for key in {**flat[0], **flat[1]}:
            both = (flat[0].get(key), flat[1].get(key))
            if both[0] != both[1]:
                found.setdefault(key, {}).setdefault(both, []).extend(some.tolist())
    return found


def _part(side: Measurements, place: int) -> Mapping[str, Any]:
    config = simulated_part(side.configs[place][0])
    return {key: value for key, value in config.items() if key not in _OF_REPETITIONS}


def _values(key: str, texts: Texts, pairs: Pairs, name: str = "") -> list[Value]:
    values = []
    for (of_a, of_b), some in texts.items():
        more = f" and {len(some) - 1} more" if len(some) > 1 else ""
        where = "" if len(some) == len(pairs) else label_text(pairs.labels[min(some)]) + more
        values.append(Value(name or key, ABSENT if of_a is None else of_a, ABSENT if of_b is None else of_b, where))
    return values


def _provenance(a: Measurements, b: Measurements) -> Iterator[Value]:
    for name in dict.fromkeys([*a.provenance, *b.provenance]):
        of_a, of_b = (join_values(side.provenance.get(name, [])) for side in (a, b))
        if name == _MACHINE:
            yield from _machines(a.machines, b.machines)
        elif name not in _NO_PHYSICS and of_a != of_b:
            yield Value(name, of_a or ABSENT, of_b or ABSENT)


def _machines(of_a: Sequence[Machine], of_b: Sequence[Machine]) -> Iterator[Value]:
    """Yield the parts in which the machines of two sides are known to differ, if the sides have other machines."""
    names = parts_apart([*of_a, *of_b])
    texts = [join_values(sorted({machine.in_words(names) for machine in some})) for some in (of_a, of_b)]
    if texts[0] != texts[1]:
        yield Value(_MACHINE, texts[0] or ABSENT, texts[1] or ABSENT)


def _both(values: Sequence[Value], key: str) -> str:
    """Return the values of a key in both, as "computed_torque against operational_space"."""
    return "; ".join(
        f"{value.a} against {value.b}{f' at {value.cells}' if value.cells else ''}"
        for value in values
        if value.key == key
    )
