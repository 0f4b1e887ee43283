"""Which axis of a sweep matters: shares of the variation, and permutation tests of main effects and interactions."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import lgamma, log

import numpy as np
from numpy.typing import NDArray

from runner.statistics.interval import CONFIDENCE, FloatArray

Levels = NDArray[np.intp]

PERMUTATIONS = 999
MOST_VALUES = 5_000
"""More values than this are drawn from at random, so that a test takes seconds."""

MOST_GROUPS = 8
"""For interactions an axis with more values is taken in so many groups of neighbours."""

_DECADE = 10.0
_AT_ONCE = 111
_NOISE = 1e-12  # share of the variation below which nothing but rounding is left


@dataclass(frozen=True)
class Effect:
    """What one axis does, or two axes beyond what each does by itself.

    Attributes:
        axes: Name of the axis, or of both.
        share: Share of the variation that it explains, 0 to 1.
        p_value: Share of permutations with as large an effect; None where the sample is too small to say.
        remark: Why there is no p-value; empty where there is one.
    """

    axes: tuple[str, ...]
    share: float
    p_value: float | None
    remark: str = ""


@dataclass(frozen=True)
class EffectAnalysis:
    """All effects on one metric.

    Attributes:
        effects: Main effects in the order of the axes, then interactions of two.
        n: Number of values used.
        left_out: Number of values left out because they are missing or beyond every number.
        logarithmic: Whether the values' logarithms were taken.
    """

    effects: Sequence[Effect]
    n: int
    left_out: int
    logarithmic: bool


def axis_effects(axes: Mapping[str, Levels], values: FloatArray, seed: int = 0) -> EffectAnalysis:
    r"""Return the effects of axes on a metric.

    An effect's share is its sum of squares beyond the model without it, over the total; a main effect stands beside
    the other main effects, an interaction beside all main effects. Tested is F,

    $$F = \frac{(RSS_0 - RSS_1) / (p_1 - p_0)}{RSS_1 / (n - p_1)},$$

    against its values after permutations of the residuals of the model without the effect (Freedman and Lane, "A
    nonstochastic interpretation of reported significance levels", J. Business & Economic Statistics 1, 1983), so
    that no distribution is assumed. Positive values that span more than a decade are taken by their logarithms: an
    interaction is then what a product of two effects leaves.

    Args:
        axes: Level of each axis at each value, shape (n,), counted from zero.
        values: The metric, shape (n,); what is not finite is left out.
        seed: Seed of the permutations.
    """
    rng = np.random.default_rng(seed)
    kept = np.flatnonzero(np.isfinite(values))
    left_out = len(values) - len(kept)
    if len(kept) > MOST_VALUES:
        kept = np.sort(rng.choice(kept, MOST_VALUES, replace=False))
    y = values[kept]
    logarithmic = bool(y.size and y.min() > 0 and y.max() > _DECADE * y.min())
    y = np.log10(y) if logarithmic else y
    levels = {name: _recoded(level[kept]) for name, level in axes.items()}
    effects = []
    for name, level in levels.items():
        others = [_indicators(other) for key, other in levels.items() if key != name]
        effects.append(_effect((name,), y, others, level, rng))
    main = [_indicators(level) for level in levels.values()]
    coarse = {name: _grouped(level) for name, level in levels.items()}
    for a, b in itertools.combinations(levels, 2):
        both = _recoded(coarse[a] * MOST_GROUPS + coarse[b])
        effects.append(_effect((a, b), y, main, both, rng))
    return EffectAnalysis(effects, len(y), left_out, logarithmic)


def _effect(
    axes: tuple[str, ...], y: FloatArray, reduced: Sequence[FloatArray], level: Levels, rng: np.random.Generator
) -> Effect:
    """Return one effect: that of the cells numbered by `level`, beyond the columns of the reduced model."""
    n = len(y)
    if n < 2:
        return Effect(axes, 0.0, None, "fewer than two values")
    base = _basis(np.column_stack([np.ones(n), *reduced]))
    columns = _indicators(level)
    added = _basis(columns - base @ (base.T @ columns))
    total = float(np.sum((y - y.mean()) ** 2))
    if total <= _NOISE * float(np.sum(y**2)):
        return Effect(axes, 0.0, None, "all values are the same")
    residual = y - base @ (base.T @ y)
    share = float(np.sum((added.T @ residual) ** 2)) / total
    freedom = n - base.shape[1] - added.shape[1]
    if added.shape[1] == 0:
        return Effect(axes, 0.0, None, "cannot be told apart from the other axes")
    if freedom < 1:
        return Effect(axes, share, None, "no repetition to tell it from chance")
    if _log_arrangements(level) < log(1 / (1 - CONFIDENCE)):
        return Effect(axes, share, None, "too few values to tell it from chance")
    if np.sum(residual**2) <= _NOISE * total:
        return Effect(axes, share, None, "nothing is left to explain")
    observed = _f_values(residual[:, None], base, added, freedom)[0]
    as_large = 0
    for _ in range(PERMUTATIONS // _AT_ONCE):
        shuffled = rng.permuted(np.tile(residual[:, None], _AT_ONCE), axis=0)
        as_large += int(np.sum(_f_values(shuffled, base, added, freedom) >= observed * (1 - 1e-9)))
    return Effect(axes, share, (1 + as_large) / (1 + PERMUTATIONS))


def _f_values(residuals: FloatArray, base: FloatArray, added: FloatArray, freedom: int) -> FloatArray:
    """Return F for each column of residuals, shape (n, m)."""
    whole, explained, kept = (np.sum(part**2, axis=0) for part in (residuals, added.T @ residuals, base.T @ residuals))
    # A noise-free sweep may leave nothing but rounding.
    left = np.maximum(whole - kept - explained, _NOISE * whole)
    values: FloatArray = (explained / added.shape[1]) / (left / freedom)
    return values


def _indicators(level: Levels) -> FloatArray:
    """Return a column for each level, 1 where a value has it, shape (n, levels)."""
    return np.eye(int(level.max(initial=0)) + 1)[level]


def _recoded(level: Levels) -> Levels:
    """Return the levels counted from zero without gaps."""
    return np.unique(level, return_inverse=True)[1]


def _grouped(level: Levels) -> Levels:
    """Return the levels, neighbours put together where there are many."""
    count = int(level.max(initial=0)) + 1
    return level * MOST_GROUPS // count if count > MOST_GROUPS else level


def _basis(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of what the columns span, shape (n, rank)."""
    squares, directions = np.linalg.eigh(columns.T @ columns)
    found = squares > 1e-9 * max(1.0, squares.max(initial=0.0))
    basis: FloatArray = columns @ (directions[:, found] / np.sqrt(squares[found]))
    return basis


def _log_arrangements(level: Levels) -> float:
    """Return the logarithm of how many ways there are to deal the values to the levels."""
    return lgamma(len(level) + 1) - sum(lgamma(count + 1) for count in np.bincount(level).tolist())
