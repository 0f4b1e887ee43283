"""Paired comparison of cells on common seeds: cells of two sweeps or runs, or two levels of a sweep axis."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.dotted_keys import split_override
from runner.base.errors import RunnerError
from runner.base.sanitize import few
from runner.statistics import Empty, PairedComparison, is_empty, subtract
from runner.store.axes import find_axis, group_cells, number_rows
from runner.sweeps.differing import value_text
from runner.sweeps.measurements import Measurements
from runner.sweeps.question import SEED

MOST_ORDERED = 6
"""An axis with more values is compared only with its first value, not each value with each."""
MOST_PAIRS = 1_000
"""Most draws in a comparison. A random selection replaces more: a million means of two are sorted in 0.1 s."""
Cells = NDArray[np.intp]
Label = Mapping[str, str]

_NAMED = 6  # values of a key that a message names


@dataclass(frozen=True, eq=False)
class Pairs:
    """Cells of two sweeps, or of one sweep, that are compared pair by pair.

    Attributes:
        a: The first sweep.
        b: The second sweep, or the first one again.
        of_a: Cells of the first sweep, shape (n,).
        of_b: Their partners in the second sweep, shape (n,).
        first: Name of the first sweep or level.
        second: Name of the second sweep or level.
        axis: Name of the axis if its levels, the names above, are numbers.
        at: Values that all pairs share: the levels that two levels are compared within, or the label of one cell.
        keys: Keys by which the cells of two sweeps are matched.
        labels: Value of each key in each pair, such as {"robot": "macro"}.
        other_seeds: Number of matched cells that are left out because their seeds differ.
        alone: Labels of the cells without a partner, of the first and of the second sweep.
    """

    a: Measurements
    b: Measurements
    of_a: Cells
    of_b: Cells
    first: str
    second: str
    at: Label
    keys: Sequence[str] = ()
    labels: Sequence[Label] = ()
    other_seeds: int = 0
    alone: tuple[Sequence[Label], Sequence[Label]] = ((), ())
    axis: str = ""

    @property
    def sides(self) -> tuple[tuple[Measurements, Cells], tuple[Measurements, Cells]]:
        """Each sweep with its cells."""
        return (self.a, self.of_a), (self.b, self.of_b)

    def __len__(self) -> int:
        """Return the number of pairs."""
        return len(self.of_a)

    @property
    def share_seeds(self) -> NDArray[np.bool_]:
        """True if both cells of each pair have the same random draws in each repetition, shape (n,)."""
        if self.a is self.b and not len(self.a.seeds):
            return np.ones(len(self), dtype=bool)
        same: NDArray[np.bool_] = np.asarray(self.a.seeds)[self.of_a] == np.asarray(self.b.seeds)[self.of_b]
        return same

    def each(self) -> "Iterator[Pairs]":
        """Yield each pair by itself."""
        for place, label in enumerate(self.labels):
            one = slice(place, place + 1)
            yield replace(self, of_a=self.of_a[one], of_b=self.of_b[one], at=label, labels=[label])


def label_text(label: Label) -> str:
    """Return the name of a cell, such as "robot=macro, controller.period=0.01"."""
    return ", ".join(f"{key}={value}" for key, value in label.items()) or "the only cell"


def compare(pairs: Pairs, metric: str) -> PairedComparison | None:
    """Return the difference of the second cells from the first in a metric; None if no repetition is in both.

    Each draw, that is a repetition of a seed, counts once, with the mean over the pairs of cells: cells of one seed
    share its draws, so they are not further evidence. A repetition without a value in either counts nothing. If nothing
    is drawn, only the first draw counts and the comparison is exact. Of more than MOST_PAIRS draws the same random
    selection is always taken.

    Args:
        pairs: The cells.
        metric: Name of a metric of both sweeps.
    """
    a, b = pairs.a, pairs.b
    copies = bool(a.copies[pairs.of_a].all() and b.copies[pairs.of_b].all())
    first, second, draws = _entries(pairs, a.values[metric], b.values[metric], 1 if copies else None)
    present = ~np.isnan(first) & ~np.isnan(second)
    if not present.any():
        return None
    empty = present & is_empty(first, second)
    both = present & ~empty
    levels = int(empty.reshape(len(pairs), -1).any(axis=1).sum())
    neither = Empty(int(empty.sum()), int(present.sum()), levels, len(pairs))
    kept, draw = np.unique(draws[both], return_inverse=True)
    differences = second[both] - first[both]
    if copies:
        chosen = np.arange(min(1, len(kept)))
    elif len(kept) > MOST_PAIRS:
        chosen = np.sort(np.random.default_rng(0).choice(len(kept), MOST_PAIRS, replace=False))
    else:
        chosen = np.arange(len(kept))
    one, other, by_draw = (_mean_by(draw, values)[chosen] for values in (first[both], second[both], differences))
    error = _error(pairs, metric) if metric in a.finer and metric in b.finer else None
    left_out = 0 if copies else len(kept) - len(chosen)
    return PairedComparison(one, other, by_draw, error, _largest_rounding(pairs, metric), copies, neither, left_out)


def _largest_rounding(pairs: Pairs, metric: str) -> float:
    """Return the largest relative change of a metric through rounding in the compared cells; 0 if it is unknown."""
    return max(
        (float(side.rounding[metric][of].max()) for side, of in pairs.sides if metric in side.rounding), default=0.0
    )


def _error(pairs: Pairs, metric: str) -> float | None:
    """Return by how much a finer step of the plant changes a difference in the median draw; None if not known."""
    a, b = pairs.a, pairs.b
    width = min(a.finer[metric].shape[1], b.finer[metric].shape[1])
    first, second, draws = _entries(pairs, a.values[metric], b.values[metric], width)
    finer_first, finer_second, _ = _entries(pairs, a.finer[metric], b.finer[metric], width)
    here = ~np.isnan(first) & ~np.isnan(second) & ~is_empty(first, second)
    known = ~np.isnan(finer_first) & ~np.isnan(finer_second)
    whole = here & ~np.isin(draws, draws[here & ~known])  # draws whose pairs are all known
    if not whole.any():
        return None
    draw = np.unique(draws[whole], return_inverse=True)[1]
    own = _mean_by(draw, subtract(second[whole], first[whole]))
    failed = is_empty(finer_first, finer_second)[whole]  # on a finer step, which leaves no number of the difference
    finer = _mean_by(draw, np.where(failed, np.inf, subtract(finer_second[whole], finer_first[whole])))
    return float(np.median(np.abs(subtract(own, finer))))


def _entries(
    pairs: Pairs, of_a: FloatArray, of_b: FloatArray, most: int | None
) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Return a metric in the first and the second cell of each pair, and the draw behind both, by repetition."""
    shown = slice(min(of_a.shape[1], of_b.shape[1])) if most is None else slice(min(of_a.shape[1], of_b.shape[1], most))
    return of_a[pairs.of_a, shown].ravel(), of_b[pairs.of_b, shown].ravel(), pairs.a.draws[pairs.of_a, shown].ravel()


def _mean_by(group: NDArray[np.intp], values: FloatArray) -> FloatArray:
    """Return the mean of the values of each group; infinite if more of them are +inf than -inf, or the reverse."""
    finite = np.isfinite(values)
    beyond = np.bincount(group, np.where(finite, 0.0, np.sign(values)))
    sums = np.bincount(group, np.where(finite, values, 0.0))
    counts = np.maximum(np.bincount(group, finite), 1.0)
    means: FloatArray = np.where(beyond == 0.0, sums / counts, np.copysign(np.inf, beyond))
    return means


def level_pairs(measurements: Measurements, axis: str, within: Sequence[str] | None = None) -> list[Pairs]:
    """Return the pairs of cells of any two levels of an axis; none if no two cells share seeds.

    Of more than MOST_ORDERED levels only those with the first one are returned. The first level is the smallest number,
    or the text that the sweep names first. The two cells of a pair have the same levels of all other axes and the same
    seed.

    Args:
        measurements: The sweep.
        axis: The axis.
        within: Axes that are held: levels are compared within each combination of their levels. None holds all
            others but the seed.

    Raises:
        RunnerError: If the sweep has no such axis.
    """
    chosen = find_axis(measurements.axes, axis)
    others = [other for other in measurements.axes if other is not chosen]
    inner = [other.name for other in others if other.name != SEED] if within is None else within
    shown = [find_axis(measurements.axes, name) for name in inner]
    if chosen in shown:
        raise RunnerError(f"within: {axis} is the compared axis. Allowed: other axes.")
    pooled = [other.level for other in others if other not in shown]
    place = number_rows(pooled, len(measurements.hashes))  # equal for cells with equal levels of the pooled axes
    found = []
    for at, cells in group_cells(shown, np.arange(len(place))):
        names = {other.name: other.text(level) for other, level in zip(shown, at, strict=True)}
        levels = [(level, some) for (level,), some in group_cells([chosen], cells)]
        few = len(chosen.values) <= MOST_ORDERED
        for (first, of_first), (level, some) in combinations(levels, 2) if few else product(levels[:1], levels[1:]):
            a, b = _partners(of_first, some, place[of_first], place[some])
            of_axis = "" if chosen.numbers is None else chosen.name
            pairs = Pairs(measurements, measurements, a, b, chosen.text(first), chosen.text(level), names, axis=of_axis)
            kept = pairs.share_seeds
            if kept.any():
                found.append(replace(pairs, of_a=a[kept], of_b=b[kept]))
    return found


def _partners(of_a: Cells, of_b: Cells, places_a: Cells, places_b: Cells) -> tuple[Cells, Cells]:
    """Return the cells whose places are in both, pair by pair, in the order of the second cells."""
    last = np.sort(len(places_b) - 1 - np.unique(places_b[::-1], return_index=True)[1])  # of equal places
    of_b, places_b, order = of_b[last], places_b[last], np.argsort(places_a, kind="stable")
    found = np.searchsorted(places_a, places_b, side="right", sorter=order) - 1
    kept = (found >= 0) & (places_a[order[found]] == places_b)
    return of_a[order[found[kept]]], of_b[kept]


def match(a: Measurements, b: Measurements) -> Pairs:
    """Match the cells of two sweeps by the values of all keys that either of them sweeps, whatever their order.

    A dotted key is matched by its resolved value, so one sweep may fix it or leave it at its default. A group, such as
    `robot`, is matched by its option if both sweeps name one, and else by the name or kind in its config. Two runs are
    the two cells of a pair.

    Raises:
        RunnerError: If no cell is in both.
    """
    keys = list(dict.fromkeys(axis.name for side in (a, b) for axis in side.axes))
    texts = {key: _values(key, a, b) for key in keys}
    sizes = len(a.hashes), len(b.hashes)
    rows = number_rows([np.unique([*of_a, *of_b], return_inverse=True)[1] for of_a, of_b in texts.values()], sum(sizes))
    places = [some * max(sizes) + _again(some) for some in np.split(rows, [sizes[0]])]
    of_b, of_a = _partners(np.arange(sizes[1]), np.arange(sizes[0]), places[1], places[0])
    if not len(of_a):
        raise RunnerError(_explain_no_match(a, b, texts))

    def labels(side: int, cells: Cells) -> list[Label]:
        return [{key: texts[key][side][cell] for key in keys} for cell in cells.tolist()]

    alone = [labels(side, np.setdiff1d(np.arange(sizes[side]), of)) for side, of in ((0, of_a), (1, of_b))]
    return Pairs(a, b, of_a, of_b, a.name, b.name, {}, keys, labels(0, of_a), 0, (alone[0], alone[1]))


def _again(rows: Cells) -> Cells:
    """Return the number of earlier equal entries of each entry, shape (n,)."""
    order = np.argsort(rows, kind="stable")
    new = np.flatnonzero(np.diff(rows[order], prepend=-1))
    again = np.empty(len(rows), dtype=np.intp)
    again[order] = np.arange(len(rows)) - np.repeat(new, np.diff([*new, len(rows)]))
    return again


def keep_common_seeds(pairs: Pairs) -> Pairs:
    """Return the matched cells that have the same seed in both sweeps.

    Raises:
        RunnerError: If there are none.
    """
    shared = pairs.share_seeds
    if not shared.any():
        raise RunnerError(
            f"{pairs.first} and {pairs.second} have {len(pairs)} cells in common, but no seed: they share no noise, so "
            "they are not compared in pairs; make one of them again with the other's seed, as in seed=0"
        )
    labels = [label for label, same in zip(pairs.labels, shared.tolist(), strict=True) if same]
    others = int((~shared).sum())
    return replace(pairs, of_a=pairs.of_a[shared], of_b=pairs.of_b[shared], labels=labels, other_seeds=others)


def _values(key: str, a: Measurements, b: Measurements) -> tuple[Sequence[str], Sequence[str]]:
    """Return the values of a key in the cells of two sweeps, written alike."""
    if key == SEED:
        of_a, of_b = (list(map(str, np.asarray(side.seeds).tolist())) for side in (a, b))
        return of_a, of_b
    resolved = [side.resolved(key) for side in (a, b)]
    first, second = _typed(key, a), _typed(key, b)
    known = all(value is not None and not isinstance(value, dict) for some in resolved for value in some)
    if first is not None and second is not None and not known:
        return first, second
    texts_a, texts_b = ([_written(value) for value in some] for some in resolved)
    return [texts_a[place] for place in a.config_of_cells], [texts_b[place] for place in b.config_of_cells]


def _typed(key: str, side: Measurements) -> Sequence[str] | None:
    """Return the values of a key as overrides give them, cell by cell; None if they do not."""
    for axis in side.axes:
        if axis.name == key:
            levels = [_canonical(str(value)) for value in axis.values]
            return [levels[level] for level in axis.level.tolist()]
    for text in side.fixed:
        name, value = split_override(text)
        if name == key:
            return [_canonical(value)] * len(side.hashes)
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
    """Return a resolved value as a string; that of a group is its name or kind."""
    return str((isinstance(value, dict) and (value.get("name") or value.get("kind"))) or value_text(value))


def _explain_no_match(
    a: Measurements, b: Measurements, texts: Mapping[str, tuple[Sequence[str], Sequence[str]]]
) -> str:
    apart = []
    for key, both in texts.items():
        of_a, of_b = (list(dict.fromkeys(some)) for some in both)
        if not set(of_a) & set(of_b):
            apart.append(f"{key} is {few(of_a, _NAMED)} in {a.name} and {few(of_b, _NAMED)} in {b.name}")
    why = "; ".join(apart) or f"no combination of {', '.join(texts)} is in both"
    return (
        f"{a.name} ({a.folder}) and {b.name} ({b.folder}) share no cell: {why}; sweep both over the same values of "
        "these, or compare the levels of one sweep: `runner compare SWEEP --by KEY`"
    )
