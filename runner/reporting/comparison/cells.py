"""Matching of the cells of two sweeps by the values of all swept keys."""

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml

from runner.base.errors import RunnerError
from runner.reporting.comparison.operand import Side
from runner.reporting.comparison.pairs import CellPairs, share_seeds
from runner.sweeps.differing import value_text

_NAMED = 6  # values of a key that a message names


@dataclass(frozen=True)
class Matched:
    """Cells of two sweeps that belong together.

    Attributes:
        keys: What they are matched by: the keys that either sweep sweeps.
        pairs: The cells that are in both and share their seeds, pair by pair.
        labels: Value of each key in each pair, such as {"robot": "macro"}.
        other_seeds: Number of cells that are in both, but with different seeds.
        alone: Labels of the cells that are in the first sweep alone, and of those that are in the second alone.
    """

    keys: Sequence[str]
    pairs: CellPairs
    labels: Sequence[Mapping[str, str]]
    other_seeds: int
    alone: tuple[Sequence[Mapping[str, str]], Sequence[Mapping[str, str]]]


def match(a: Side, b: Side) -> Matched:
    """Match the cells of two sweeps by the values of all keys that either of them sweeps, in whatever order.

    A dotted key is matched by its resolved value, so one sweep may fix it, or leave it as it is. A group, such as
    `robot`, is matched by its option where both sweeps name one, and else by the name or kind in its config.

    Raises:
        RunnerError: If no cell is in both, or none with the same seed.
    """
    keys = list(dict.fromkeys(axis.name for side in (a, b) for axis in side.measurements.axes))
    texts = {key: _values(key, a, b) for key in keys}
    places = [_places([texts[key][side] for key in keys], len(one.measurements.hashes))
              for side, one in enumerate((a, b))]  # fmt: skip
    both = [place for place in places[0] if place in places[1]]
    alone = [[place for place in some if place not in other] for some, other in (places, places[::-1])]
    if not both:
        raise RunnerError(_nothing_shared(a, b, keys, texts))
    pairs = CellPairs(np.array([places[0][place] for place in both]), np.array([places[1][place] for place in both]))
    shared = share_seeds(a.measurements, b.measurements, pairs)
    if not shared.any():
        raise RunnerError(
            f"{a.name} and {b.name} have {len(both)} cells in common, but no seed: they share no noise, so they are "
            "not compared in pairs; make one of them again with the other's seed, as in seed=0"
        )

    def label(place: Sequence[object]) -> Mapping[str, str]:
        return dict(zip(keys, map(str, place), strict=False))  # behind the keys stands which of equal cells it is

    return Matched(
        keys,
        CellPairs(pairs.a[shared], pairs.b[shared]),
        [label(place) for place, same in zip(both, shared.tolist(), strict=True) if same],
        int((~shared).sum()),
        (list(map(label, alone[0])), list(map(label, alone[1]))),
    )


def one_cell() -> Matched:
    """Return that the only cells of two sweeps belong together, as those of two runs do."""
    return Matched((), CellPairs(np.array([0]), np.array([0])), [{}], 0, ((), ()))


def label_text(label: Mapping[str, str]) -> str:
    """Return the name of a cell, such as "robot=macro, controller.period=0.01"."""
    return ", ".join(f"{key}={value}" for key, value in label.items()) or "the only cell"


def _places(columns: Sequence[Sequence[str]], cells: int) -> dict[tuple[object, ...], int]:
    """Return the cell at each combination of values; equal cells are counted."""
    rows = list(zip(*columns, strict=True)) if columns else [()] * cells
    found: dict[tuple[object, ...], int] = {}
    again: dict[tuple[object, ...], int] = {}
    for cell, row in enumerate(rows):
        count = again.get(row, 0)
        again[row] = count + 1
        found[(*row, count)] = cell
    return found


def _values(key: str, a: Side, b: Side) -> tuple[Sequence[str], Sequence[str]]:
    """Return the values of a key in the cells of two sweeps, written alike."""
    if key == "seed":
        return _seeds(a), _seeds(b)
    resolved = [side.resolved(key) for side in (a, b)]
    typed = [_typed(key, side) for side in (a, b)]
    known = all(value is not None and not isinstance(value, dict) for some in resolved for value in some)
    first, second = typed
    if first is not None and second is not None and not known:
        return first, second
    of_a, of_b = ([_written(value) for value in some] for some in resolved)
    return [of_a[place] for place in a.config_of_cells()], [of_b[place] for place in b.config_of_cells()]


def _seeds(side: Side) -> Sequence[str]:
    return [str(seed) for seed in np.asarray(side.measurements.seeds).tolist()]


def _typed(key: str, side: Side) -> Sequence[str] | None:
    """Return the values of a key as overrides give them, cell by cell; None where they do not."""
    measurements = side.measurements
    for axis in measurements.axes:
        if axis.name == key:
            levels = [_canonical(str(value)) for value in axis.values]
            return [levels[level] for level in axis.level.tolist()]
    for text in measurements.fixed:
        name, _, value = text.partition("=")
        if name == key:
            return [_canonical(value)] * len(measurements.hashes)
    return None


def _canonical(text: str) -> str:
    """Return an override's value as a resolved one would be written."""
    value: Any = text
    with contextlib.suppress(yaml.YAMLError):
        value = yaml.safe_load(text)
    with contextlib.suppress(ValueError, TypeError):
        value = float(text)
    return value_text(value)


def _written(value: Any) -> str:
    """Return a resolved value as text; that of a group is what it calls itself."""
    if isinstance(value, dict):
        return str(value.get("name") or value.get("kind") or value_text(value))
    return value_text(value)


def _nothing_shared(
    a: Side, b: Side, keys: Sequence[str], texts: Mapping[str, tuple[Sequence[str], Sequence[str]]]
) -> str:
    apart = []
    for key in keys:
        of_a, of_b = (list(dict.fromkeys(some)) for some in texts[key])
        if not set(of_a) & set(of_b):
            apart.append(f"{key} is {_some(of_a)} in {a.name} and {_some(of_b)} in {b.name}")
    why = "; ".join(apart) or f"no combination of {', '.join(keys)} is in both"
    return (
        f"{a.name} ({a.folder}) and {b.name} ({b.folder}) share no cell: {why}; sweep both over the same values of "
        "these, or compare the levels of one sweep: `runner compare SWEEP --by KEY`"
    )


def _some(values: Sequence[str]) -> str:
    more = f" and {len(values) - _NAMED} more" if len(values) > _NAMED else ""
    return ", ".join(values[:_NAMED]) + more
