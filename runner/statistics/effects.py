"""Effects of sweep axes: explained variation, and permutation tests of main effects and interactions, within blocks."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import lgamma, log

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.statistics.interval import CONFIDENCE

Levels = NDArray[np.intp]

_AT_ONCE = 111  # permutations in memory together
_MOST_VALUES = 2_000_000  # in memory together
_NOISE = 1e-12  # share of the variation below which nothing but rounding is left


@dataclass(frozen=True)
class Tested:
    """Fraction of the variation that a factor explains, with the p-value of a permutation test.

    Attributes:
        share: Share of the variation that it explains, 0 to 1.
        p_value: Share of permutations with as large an effect, the observed order among them; None where the sample is
            too small to say.
        remark: Reason for a missing p-value; empty if it exists.
    """

    share: float
    p_value: float | None
    remark: str = ""


class Sample:
    """Values whose scatter is permuted.

    Args:
        y: The values, shape (n,).
        blocks: Number of each value's block, shape (n,); all different where no two have anything in common.
        rng: Draws the permutations.
        permutations: Number of permutations.
    """

    def __init__(self, y: FloatArray, blocks: Levels, rng: np.random.Generator, permutations: int) -> None:
        self._y = y
        # Values that have nothing in common with each other make one block, within which all of them are permuted.
        self._blocks = recode_levels(blocks) if np.unique(blocks).size < len(y) else np.zeros(len(y), dtype=np.intp)
        self._sizes = np.bincount(self._blocks)
        starts, order = np.cumsum(self._sizes) - self._sizes, np.argsort(self._blocks, kind="stable")
        self._rows = [
            order[starts[self._sizes == size][:, None] + np.arange(size)]
            for size in np.unique(self._sizes[self._sizes > 1]).tolist()
        ]
        self._first = order[starts]
        self._rng, self._permutations = rng, permutations
        self._total = float(np.sum((y - y.mean()) ** 2)) if y.size else 0.0

    def shared(self) -> float | None:
        """Return the fraction of the variation between blocks; None without blocks."""
        if len(self._sizes) < 2 or not self._varies():
            return None
        return 1.0 - float(np.sum(self._centred(self._y) ** 2)) / self._total

    def test(self, others: Sequence[Levels], level: Levels) -> Tested:
        """Test what a factor explains beyond other factors.

        Args:
            others: Levels of the other factors at each value, each of shape (n,).
            level: Levels of the factor, shape as above.
        """
        if len(self._y) < 2:
            return Tested(0.0, None, "fewer than two values")
        if not self._varies():
            return Tested(0.0, None, "all values are the same")
        share = self._share(others, level)
        if len(self._sizes) > 1 and self._constant(level):
            tested = self._means().test([other[self._first] for other in others if self._constant(other)],
                                        level[self._first])  # fmt: skip
            return Tested(share, tested.p_value, tested.remark)
        base, added = self._bases(others, level, self._blocks)
        freedom = len(self._y) - len(self._sizes) - base.shape[1] - added.shape[1]
        if added.shape[1] == 0:
            return Tested(0.0, None, "cannot be told apart from the other axes")
        if freedom < 1:
            return Tested(share, None, "no repetition to tell it from chance")
        if self._log_arrangements(level) < log(1 / (1 - CONFIDENCE)):
            return Tested(share, None, "too few values to tell it from chance")
        residual = self._centred(self._y)
        residual = residual - base @ (base.T @ residual)
        if np.sum(residual**2) <= _NOISE * self._total:
            return Tested(share, None, "nothing is left to explain")
        observed = _f_values(residual[:, None], base, added, freedom)[0]
        as_large = 0
        at_once = min(_AT_ONCE, max(1, _MOST_VALUES // len(residual)))
        for done in range(0, self._permutations, at_once):
            shuffled = self._permuted(residual, min(at_once, self._permutations - done))
            as_large += int(np.sum(_f_values(shuffled, base, added, freedom) >= observed * (1 - 1e-9)))
        return Tested(share, (1 + as_large) / (1 + self._permutations))

    def _varies(self) -> bool:
        return self._total > _NOISE * float(np.sum(self._y**2))

    def _constant(self, level: Levels) -> bool:
        """Return whether a factor has one level only within each block."""
        return bool((level == level[self._first][self._blocks]).all())

    def _means(self) -> "Sample":
        means = np.bincount(self._blocks, self._y) / self._sizes
        return Sample(means, np.arange(len(means)), self._rng, self._permutations)

    def _share(self, others: Sequence[Levels], level: Levels) -> float:
        """Return the sum of squares of a factor beyond others over the total, whatever the blocks."""
        base, added = self._bases(others, level, np.zeros(len(self._y), dtype=np.intp))
        centred = self._y - self._y.mean()
        return float(np.sum((added.T @ (centred - base @ (base.T @ centred))) ** 2)) / self._total

    def _bases(self, others: Sequence[Levels], level: Levels, blocks: Levels) -> tuple[FloatArray, FloatArray]:
        """Return the space that other factors span beyond the blocks, and that of a factor beyond both."""
        columns = [_indicators(other) for other in others]
        base = _basis(_centred(np.column_stack(columns), blocks)) if columns else np.zeros((len(blocks), 0))
        added = _centred(_indicators(level), blocks)
        return base, _basis(added - base @ (base.T @ added))

    def _centred(self, values: FloatArray) -> FloatArray:
        return _centred(values[:, None], self._blocks)[:, 0]

    def _permuted(self, residual: FloatArray, count: int) -> FloatArray:
        """Return residuals permuted within their blocks in `count` ways, shape (n, count)."""
        shuffled = np.zeros((len(residual), count))  # what a block of one value has left is zero
        for rows in self._rows:
            copies = np.repeat(residual[rows][:, :, None], count, axis=2)
            shuffled[rows] = self._rng.permuted(copies, axis=1)
        return shuffled

    def _log_arrangements(self, level: Levels) -> float:
        """Return the logarithm of how many ways there are to deal the values to the levels, block by block."""
        counts = np.bincount(self._blocks * (int(level.max()) + 1) + level)
        return sum(lgamma(size + 1) for size in self._sizes.tolist()) - sum(lgamma(c + 1) for c in counts.tolist())


def recode_levels(level: Levels) -> Levels:
    """Return levels counted from zero without gaps."""
    return np.unique(level, return_inverse=True)[1]


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


def _centred(columns: FloatArray, blocks: Levels) -> FloatArray:
    """Return columns, shape (n, m), less their means within each block."""
    sums = np.zeros((int(blocks.max(initial=0)) + 1, columns.shape[1]))
    np.add.at(sums, blocks, columns)
    centred: FloatArray = columns - (sums / np.maximum(np.bincount(blocks), 1)[:, None])[blocks]
    return centred


def _basis(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of what the columns span, shape (n, rank)."""
    squares, directions = np.linalg.eigh(columns.T @ columns)
    found = squares > 1e-9 * max(1.0, squares.max(initial=0.0))
    basis: FloatArray = columns @ (directions[:, found] / np.sqrt(squares[found]))
    return basis


PERMUTATIONS = 999
MOST_VALUES = 5_000
"""More values than this are drawn from at random, so that a test takes seconds."""

MOST_GROUPS = 8
"""For interactions an axis with more values is divided into this many groups of neighbours."""

_DECADE = 10.0


@dataclass(frozen=True)
class Effect(Tested):
    """Effect of one axis, or interaction of two axes.

    Attributes:
        axes: Name of the axis, or of both.
    """

    axes: tuple[str, ...] = ()


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
    axes: Mapping[str, Levels],
    values: FloatArray,
    blocks: Levels | None = None,
    seed: int = 0,
    permutations: int = PERMUTATIONS,
) -> EffectAnalysis:
    r"""Return the effects of axes on a metric.

    An effect's share is its sum of squares beyond the model without it, over the total; a main effect is added to
    the other main effects, an interaction to all main effects. Tested is F,

    $$F = \frac{(RSS_0 - RSS_1) / (p_1 - p_0)}{RSS_1 / (n - p_1)},$$

    against its values after permutations of the residuals of the model without the effect (Freedman and Lane, "A
    nonstochastic interpretation of reported significance levels", J. Business & Economic Statistics 1, 1983), so
    that no distribution is assumed. Positive values that span more than a decade are taken by their logarithms: an
    interaction is then what a product of two effects leaves.

    Values of one block have something in common, such as the seed of one repetition. Both models then have a constant
    for each block as well, which is to subtract each block's mean from everything first, and residuals are permuted
    within their block: what all cells of a repetition share is not scatter between them. An axis that has one level
    only within each block, such as the seed itself, is tested over the means of the blocks.

    The test assumes that without the effect residuals are exchangeable (within their block). Where their scatter
    differs between the levels they are not, and small p-values are more frequent than they should be.

    Args:
        axes: Level of each axis at each value, shape (n,), counted from zero.
        values: The metric, shape (n,); what is not finite is left out.
        blocks: Number of the block of each value, shape (n,); None where no two have anything in common.
        seed: Seed of the permutations.
        permutations: Number of permutations.
    """
    rng = np.random.default_rng(seed)
    kept = np.flatnonzero(np.isfinite(values))
    left_out = len(values) - len(kept)
    of = np.arange(len(kept)) if blocks is None else recode_levels(blocks[kept])
    if len(kept) > MOST_VALUES:
        drawn = _drawn(of, rng)
        kept, of = kept[drawn], of[drawn]
    y = values[kept]
    logarithmic = bool(y.size and y.min() > 0 and y.max() > _DECADE * y.min())
    sample = Sample(np.log10(y) if logarithmic else y, of, rng, permutations)
    levels = {name: recode_levels(level[kept]) for name, level in axes.items()}
    beside = {name: [other for key, other in levels.items() if key != name] for name in levels}
    tests = [((name,), beside[name], level) for name, level in levels.items()]
    coarse = {name: _grouped(level) for name, level in levels.items()}
    pairs = itertools.combinations(levels, 2)
    both = [((a, b), list(levels.values()), recode_levels(coarse[a] * MOST_GROUPS + coarse[b])) for a, b in pairs]
    effects = [Effect(**vars(sample.test(others, level)), axes=names) for names, others, level in [*tests, *both]]
    return EffectAnalysis(effects, len(y), left_out, logarithmic, sample.shared())


def _drawn(blocks: Levels, rng: np.random.Generator) -> Levels:
    """Return the places of the drawn values: whole blocks, at random."""
    rank = rng.permutation(int(blocks.max()) + 1)
    order = np.lexsort((rng.random(len(blocks)), rank[blocks]))
    return np.sort(order[:MOST_VALUES])


def _grouped(level: Levels) -> Levels:
    """Return the levels, neighbours put together where there are many."""
    count = int(level.max(initial=0)) + 1
    return level * MOST_GROUPS // count if count > MOST_GROUPS else level
