"""Effects of sweep axes: shares of the variation that each axis, and two axes together, explain beyond others."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray

Levels = NDArray[np.intp]

MOST_VALUES = 5_000
"""More values than this are drawn from at random, so that an analysis takes seconds."""

MOST_GROUPS = 8
"""For interactions an axis with more values is divided into this many groups of neighbours."""

_DECADE = 10.0
_NOISE = 1e-12  # share of the variation below which nothing but rounding is left


@dataclass(frozen=True)
class Effect:
    """Effect of one axis, or interaction of two axes.

    Attributes:
        share: Share of the variation that it explains, 0 to 1.
        axes: Name of the axis, or of both.
        remark: Reason if no share can be given; empty otherwise.
    """

    share: float
    axes: tuple[str, ...]
    remark: str = ""


@dataclass(frozen=True)
class EffectAnalysis:
    """All effects on one metric.

    Attributes:
        effects: Main effects in the order of the axes, then interactions of two.
        n: Number of values used.
        left_out: Number of values left out because they are missing or beyond every number.
        logarithmic: Whether the values' logarithms were taken.
        shared: Share of the variation that lies between blocks, 0 to 1; None where no two values share one.
    """

    effects: Sequence[Effect]
    n: int
    left_out: int
    logarithmic: bool
    shared: float | None = None


def axis_effects(
    axes: Mapping[str, Levels], values: FloatArray, blocks: Levels | None = None, seed: int = 0
) -> EffectAnalysis:
    """Return the effects of axes on a metric.

    An effect's share is its sum of squares beyond the model without it, over the total; a main effect is judged with
    the other main effects, an interaction with all main effects. Positive values that span more than a decade are
    taken by their logarithms: an interaction is then what a product of two effects leaves.

    Args:
        axes: Level of each axis at each value, shape (n,), counted from zero.
        values: The metric, shape (n,); what is not finite is left out.
        blocks: Number of the block of each value, such as the seed of one repetition, shape (n,); None where no two
            have anything in common.
        seed: Seed of the selection of values.
    """
    kept = np.flatnonzero(np.isfinite(values))
    left_out = len(values) - len(kept)
    of = np.arange(len(kept)) if blocks is None else recode_levels(blocks[kept])
    if len(kept) > MOST_VALUES:
        drawn = _drawn(of, np.random.default_rng(seed))
        kept, of = kept[drawn], recode_levels(of[drawn])
    y = values[kept]
    logarithmic = bool(y.size and y.min() > 0 and y.max() > _DECADE * y.min())
    y = np.log10(y) if logarithmic else y
    levels = {name: recode_levels(level[kept]) for name, level in axes.items()}
    beside = {name: [other for key, other in levels.items() if key != name] for name in levels}
    tests = [((name,), beside[name], level) for name, level in levels.items()]
    coarse = {name: _grouped(level) for name, level in levels.items()}
    pairs = itertools.combinations(levels, 2)
    both = [((a, b), list(levels.values()), recode_levels(coarse[a] * MOST_GROUPS + coarse[b])) for a, b in pairs]
    effects = [_effect(names, y, others, level) for names, others, level in [*tests, *both]]
    return EffectAnalysis(effects, len(y), left_out, logarithmic, _shared(y, of))


def _effect(names: tuple[str, ...], y: FloatArray, others: Sequence[Levels], level: Levels) -> Effect:
    """Return what a factor explains beyond other factors; all levels have shape (n,)."""
    if len(y) < 2:
        return Effect(0.0, names, "fewer than two values")
    centred = y - y.mean()
    total = float(np.sum(centred**2))
    if total <= _NOISE * float(np.sum(y**2)):
        return Effect(0.0, names, "all values are the same")
    base = _basis(_centred(np.column_stack(list(map(_indicators, others))))) if others else np.zeros((len(y), 0))
    columns = _centred(_indicators(level))
    added = _basis(columns - base @ (base.T @ columns))
    if added.shape[1] == 0:
        return Effect(0.0, names, "cannot be told apart from the other axes")
    return Effect(float(np.sum((added.T @ (centred - base @ (base.T @ centred))) ** 2)) / total, names)


def _shared(y: FloatArray, blocks: Levels) -> float | None:
    """Return the share of the variation between blocks; None without blocks or variation."""
    sizes = np.bincount(blocks)
    if len(sizes) < 2 or len(sizes) == len(y):
        return None
    total = float(np.sum((y - y.mean()) ** 2))
    if total <= _NOISE * float(np.sum(y**2)):
        return None
    means = np.bincount(blocks, y) / sizes
    return 1.0 - float(np.sum((y - means[blocks]) ** 2)) / total


def recode_levels(level: Levels) -> Levels:
    """Return levels counted from zero without gaps."""
    return np.unique(level, return_inverse=True)[1]


def _indicators(level: Levels) -> FloatArray:
    """Return a column for each level, 1 where a value has it, shape (n, levels)."""
    return np.eye(int(level.max(initial=0)) + 1)[level]


def _centred(columns: FloatArray) -> FloatArray:
    """Return columns, shape (n, m), less their means."""
    centred: FloatArray = columns - columns.mean(axis=0)
    return centred


def _basis(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of what the columns span, shape (n, rank)."""
    squares, directions = np.linalg.eigh(columns.T @ columns)
    found = squares > 1e-9 * max(1.0, squares.max(initial=0.0))
    basis: FloatArray = columns @ (directions[:, found] / np.sqrt(squares[found]))
    return basis


def _drawn(blocks: Levels, rng: np.random.Generator) -> Levels:
    """Return the places of the drawn values: whole blocks, at random."""
    rank = rng.permutation(int(blocks.max()) + 1)
    order = np.lexsort((rng.random(len(blocks)), rank[blocks]))
    return np.sort(order[:MOST_VALUES])


def _grouped(level: Levels) -> Levels:
    """Return the levels, neighbours put together where there are many."""
    count = int(level.max(initial=0)) + 1
    return level * MOST_GROUPS // count if count > MOST_GROUPS else level
