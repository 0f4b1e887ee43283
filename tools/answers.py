"""Error rate of the rule for verdicts: simulated sweeps of two laws at three levels, eight seeds each.

Target: of sweeps of equal laws at most 6 % say a winner in a metric, in any cell of the map of answers or in the pooled
sentence; of equal laws in another floating-point order none of 1,000; and a difference of one standard deviation of the
pairs is said in 95 % or more, of 20 pairs. Equal laws that draw alike pass through the whole comparison.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from runner.reporting.answers import judge
from runner.reporting.asked import AskedComparison
from runner.reporting.comparison.sweeps import compare_levels
from runner.reporting.conditions import conditions_of
from runner.statistics import compare_paired
from runner.store.axes import Axis
from runner.sweeps.measurements import Measurements

PRIMARY, OTHER = "max_tracking_error", "peak_torque"
_LEVELS, _SEEDS = 3, 8
_MOST_FALSE, _LEAST_TRUE = 0.06, 0.95

FloatArray = NDArray[np.float64]
Draw = Callable[[np.random.Generator], FloatArray]
"""Values of a metric, shape (law, level, seed)."""


def apart(rng: np.random.Generator) -> FloatArray:
    """Return heavy-tailed values whose pairs have a part in common, each with its own scatter."""
    common = rng.standard_t(2, (1, _LEVELS, _SEEDS))
    return np.exp(0.5 * common + 0.2 * rng.standard_t(2, (2, _LEVELS, _SEEDS)))


def wrong_masses(rng: np.random.Generator) -> FloatArray:
    """Return values where a seed draws wrong masses for all levels, which each law takes in its own way."""
    common, own = rng.normal(size=(1, 1, _SEEDS)), rng.standard_t(3, (2, 1, _SEEDS))
    return np.exp(common + 0.2 * own + 0.01 * rng.normal(size=(2, _LEVELS, _SEEDS)))


def ticked(rng: np.random.Generator) -> FloatArray:
    """Return values in whole ticks; many are equal, and some are infinite."""
    ticks = 10.0 + rng.poisson(2.0, (1, 1, _SEEDS)) + rng.integers(0, 3, (2, _LEVELS, _SEEDS))
    return np.where(rng.random((2, _LEVELS, _SEEDS)) < 0.05, np.inf, ticks)


CASES: dict[str, Draw] = {"heavy tails": apart, "wrong masses shared by levels": wrong_masses, "ticks": ticked}


def false_answers(draw: Draw, sweeps: int) -> tuple[float, float]:
    """Return the proportions of sweeps of equal laws with a winner in the first metric, and in the other one."""
    said = [_said({PRIMARY: draw(rng), OTHER: draw(rng)}) for rng in map(np.random.default_rng, range(sweeps))]
    first, other = np.mean(said, axis=0).tolist()
    return first, other


def same_law(sweeps: int) -> int:
    """Return in how many sweeps a winner is said where the laws are one, in another floating-point order."""
    return sum(any(_said({PRIMARY: _reordered(rng), OTHER: _rounding(rng)}))
               for rng in map(np.random.default_rng, range(sweeps)))  # fmt: skip


def true_answers(samples: int) -> float:
    """Return the proportion of samples of 20 pairs that show a difference of one standard deviation."""
    return float(np.mean([_shown(rng) for rng in map(np.random.default_rng, range(samples))]))


def _said(metrics: dict[str, FloatArray]) -> tuple[bool, bool]:
    """Return True for a winner in the first metric, and in the other one: pooled, or in a cell of the map."""
    laws, levels = np.divmod(np.arange(2 * _LEVELS), _LEVELS)
    measured = Measurements(
        axes=[Axis("controller", ["a", "b"], laws), Axis("noise.position", [1.0, 2.0, 3.0], levels)],
        fixed=[],
        hashes=[str(cell) for cell in range(2 * _LEVELS)],
        statuses=["ok"] * 2 * _LEVELS,
        failures=[""] * 2 * _LEVELS,
        units=dict.fromkeys(metrics, "m"),
        values={name: values.reshape(2 * _LEVELS, _SEEDS) for name, values in metrics.items()},
        provenance={},
    )
    answers = compare_levels(measured, "controller", None, list(metrics))
    said = {
        metric: any(one.sign for one in answers if one.metric == metric and not one.at)
        or any(each.winner for each in conditions_of(answers, metric))
        for metric in metrics
    }
    return said[PRIMARY], said[OTHER]


def _reordered(rng: np.random.Generator) -> FloatArray:
    """Return control efforts of one trace, of about 10^6 N^2 m^2 s, summed up from its largest and from its least."""
    trace = np.sort(1e4 * rng.normal(size=(_LEVELS, _SEEDS, 100)) ** 2, axis=2)
    return np.stack([np.cumsum(trace[..., ::-1], axis=2)[..., -1], np.cumsum(trace, axis=2)[..., -1]])


def _rounding(rng: np.random.Generator) -> FloatArray:
    """Return rounding errors of zero; those of the second law are always ten times as large."""
    return np.abs(rng.normal(size=(2, _LEVELS, _SEEDS))) * np.array([1e-16, 1e-15])[:, None, None]


def _shown(rng: np.random.Generator) -> bool:
    a = rng.normal(10.0, 3.0, 20)
    b = a + rng.normal(1.0, 1.0, 20)
    return judge([AskedComparison(PRIMARY, "m", compare_paired(a, b))], [PRIMARY])[0].sign > 0


def main() -> bool:
    """Print the table; return whether all targets are met."""
    met = []
    print("share of 2,000 sweeps of equal laws in which a winner is said: first metric, other metric")
    for name, draw in CASES.items():
        found = false_answers(draw, 2000)
        met.append(max(found) <= _MOST_FALSE)
        print(f"  {name:30} {100 * found[0]:4.1f} % {100 * found[1]:4.1f} %")
    same, shown = same_law(1000), true_answers(2000)
    print(f"winners of 1,000 sweeps of one law in another floating-point order: {same}")
    print(f"20 pairs, a difference of one standard deviation of the pairs: said in {100 * shown:.1f} %")
    return all(met) and same == 0 and shown >= _LEAST_TRUE
