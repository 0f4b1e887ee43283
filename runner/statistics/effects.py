"""Effects of sweep axes: explained variation, and permutation tests of main effects and interactions."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.statistics.permutation import Levels, Sample, Tested, recode_levels

PERMUTATIONS = 999
MOST_VALUES = 5_000
"""More values than this are drawn from at random, so that a test takes seconds."""

MOST_GROUPS = 8
"""For interactions an axis with more values is taken in so many groups of neighbours."""

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

    An effect's share is its sum of squares beyond the model without it, over the total; a main effect stands beside
    the other main effects, an interaction beside all main effects. Tested is F,

    $$F = \frac{(RSS_0 - RSS_1) / (p_1 - p_0)}{RSS_1 / (n - p_1)},$$

    against its values after permutations of the residuals of the model without the effect (Freedman and Lane, "A
    nonstochastic interpretation of reported significance levels", J. Business & Economic Statistics 1, 1983), so
    that no distribution is assumed. Positive values that span more than a decade are taken by their logarithms: an
    interaction is then what a product of two effects leaves.

    Values of one block have something in common, such as the seed of one repetition. Both models then have a constant
    for each block as well, which is to subtract each block's mean from everything first, and residuals are permuted
    within their block: what all cells of a repetition share is no scatter between them. An axis that has one level
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
    effects = [_effect(names, sample.test(others, level)) for names, others, level in [*tests, *both]]
    return EffectAnalysis(effects, len(y), left_out, logarithmic, sample.shared())


def _effect(axes: tuple[str, ...], tested: Tested) -> Effect:
    return Effect(tested.share, tested.p_value, tested.remark, axes)


def _drawn(blocks: Levels, rng: np.random.Generator) -> Levels:
    """Return the places of the drawn values: whole blocks, at random."""
    rank = rng.permutation(int(blocks.max()) + 1)
    order = np.lexsort((rng.random(len(blocks)), rank[blocks]))
    return np.sort(order[:MOST_VALUES])


def _grouped(level: Levels) -> Levels:
    """Return the levels, neighbours put together where there are many."""
    count = int(level.max(initial=0)) + 1
    return level * MOST_GROUPS // count if count > MOST_GROUPS else level
