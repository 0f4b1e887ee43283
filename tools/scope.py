"""Error rates of the words of a challenge and of turning values, on drawn values without simulation.

Targets: of problems of equal laws at most 5 % say "holds", "appears" or "reversed" of any variation; of problems with a
true difference and little power at most 5 % say "vanishes"; at least 90 % of the variations without an effect vanish by
24 pairs if pairs scatter by 5 % and the asked effect is 28 %; at least 93 % of the spans contain the turning value, and
their median length is at most 1.3 times 2 t s / (slope sqrt(n)). The pairs that a pilot of eight counts show their
difference in 75 to 85 % of cases, on average over pilots.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from runner.reporting.sweep.detect import PILOT
from runner.statistics import PairedComparison, compare_paired
from runner.statistics.conclusion import ALPHA, conclusion_sign
from runner.statistics.scope import AskedEffect, JudgedVariation, TriedVariation, came_back, first_pairs, judge_in_looks
from runner.statistics.turning import PAIRS, find_turns

PROBLEMS = 1000
SEED = 79
VARIATIONS = 24
_STORED = 10  # pairs of the asked comparison
_ASKED = -0.28
_WRONG = ("holds", "holds, weaker", "appears", "reversed")
_SIZES, _FAMILIES = (0.3, 0.5, 1.0), (1, 6)  # differences over the scatter of pairs; comparisons of a question
_POWERS = 0.75, 0.85
_MOST_FALSE, _LEAST_TOLD, _LEAST_COVERED, _LONGEST = 0.05, 0.90, 0.93, 1.3

FloatArray = NDArray[np.float64]


def main() -> bool:
    """Print the rates; return True if all targets are reached."""
    print(f"seed {SEED}, {PROBLEMS} problems of {VARIATIONS} variations for each row")
    rates = {name: false_words(name) for name in SCATTERS}
    for name, rate in rates.items():
        print(f"equal laws, {name}: {100 * rate:.1f} % with a false word")
    hidden = {effect: false_vanishing(effect) for effect in (-0.08, -0.1, -0.14)}
    for effect, rate in hidden.items():
        print(f"true effect {100 * effect:.0f} %, asked {100 * _ASKED:.0f} %: {100 * rate:.1f} % say vanishes")
    told = told_by(24)
    print(f"no effect, scatter of pairs 5 %: {100 * told:.1f} % of the variations vanish by 24 pairs")
    covered, length = turning_values()
    print(f"turning value: {100 * covered:.1f} % of the spans contain it; length {length:.2f} times the normal one")
    powers = {(size, family): power_of_counts(size, family) for size in _SIZES for family in _FAMILIES}
    for (size, family), power in powers.items():
        print(f"pilot of {PILOT}, {size:g} scatters, {family} comparisons: shown in {100 * power:.1f} %")
    return (
        max(*rates.values(), *hidden.values()) <= _MOST_FALSE
        and told >= _LEAST_TOLD
        and covered >= _LEAST_COVERED
        and length <= _LONGEST
        and all(_POWERS[0] <= power <= _POWERS[1] for power in powers.values())
    )


def normal(rng: np.random.Generator, shape: tuple[int, ...]) -> FloatArray:
    """Return normal scatter."""
    return 0.1 * rng.standard_normal(shape)


def heavy(rng: np.random.Generator, shape: tuple[int, ...]) -> FloatArray:
    """Return scatter with heavy tails."""
    return 0.05 * rng.standard_t(2, shape)


SCATTERS = {"normal": normal, "heavy tails": heavy}


def false_words(scatter: str) -> float:
    """Return the share of problems of equal laws with a false word; half of the scatter is shared by variations."""
    draw = SCATTERS[scatter]
    found = 0
    for rng in _generators(0):
        stored = _compared(draw(rng, (_STORED,)))
        sign = conclusion_sign(stored, (stored.p_value or 1.0) < ALPHA)
        pairs = first_pairs(VARIATIONS)
        own, common = draw(rng, (VARIATIONS, 4 * pairs)), draw(rng, (4 * pairs,))
        fresh = _compared(common[:pairs])
        if came_back(fresh, sign, ALPHA) is None:
            continue  # the challenge stops and says so
        asked = AskedEffect(sign, fresh.difference / max(fresh.medians))
        found += any(one.word in _WRONG for one in _words(common + own, asked))
    return found / PROBLEMS


def false_vanishing(effect: float) -> float:
    """Return the share of problems in which a variation vanishes whose true effect exceeds the margin."""
    asked = AskedEffect(-1, _ASKED)
    found = 0
    for rng in _generators(1):
        pairs = first_pairs(VARIATIONS)
        log = np.log1p(effect) + normal(rng, (VARIATIONS, 4 * pairs)) + normal(rng, (4 * pairs,))
        found += any(one.word == "vanishes" for one in _words(log, asked))
    return found / PROBLEMS


def told_by(pairs: int) -> float:
    """Return the share of variations without an effect that vanish by a number of pairs; pairs scatter by 5 %."""
    asked = AskedEffect(-1, _ASKED)
    words = [
        one
        for rng in _generators(2)
        for one in _words(0.05 * rng.standard_normal((VARIATIONS, 4 * first_pairs(VARIATIONS))), asked)
    ]
    return float(np.mean([one.word == "vanishes" and one.pairs <= pairs for one in words]))


def turning_values() -> tuple[float, float]:
    """Return the share of spans that contain the turning value, and their median length over the normal one."""
    from scipy.special import stdtrit

    inside, lengths = [], []
    for rng in _generators(3):
        true, scatter = rng.uniform(0.2, 0.8), rng.uniform(0.02, 0.1)
        slopes, offsets = 1.0 + 0.2 * rng.standard_normal(PAIRS), scatter * rng.standard_normal(PAIRS)

        def ask(
            values: Sequence[float], true: float = true, slopes: FloatArray = slopes, offsets: FloatArray = offsets
        ) -> list[FloatArray]:
            return [slopes * np.float64(np.expm1(value - true)) + offsets for value in values]

        turns = find_turns(ask, np.linspace(0.0, 1.0, 5).tolist())
        inside.append(any(_contains(turn.low, turn.high, true) for turn in turns))
        spans = [turn.high - turn.low for turn in turns if turn.low is not None and turn.high is not None]
        usual = 2.0 * -stdtrit(PAIRS - 1, 0.025) * scatter / np.sqrt(PAIRS)
        lengths += [span / usual for span in spans]
    return float(np.mean(inside)), float(np.median(lengths))


def power_of_counts(size: float, family: int) -> float:
    """Return the share of problems in which as many pairs as a pilot counts show a difference.

    Args:
        size: The difference over the standard deviation of a pair.
        family: Number of comparisons that share the error rate.
    """
    level = ALPHA / family
    shown = 0
    for rng in _generators(4):
        nothing = np.zeros(PILOT)
        count = compare_paired(nothing, rng.standard_normal(PILOT)).pairs_needed(size, level)
        assert count is not None
        found = compare_paired(np.zeros(count), size + rng.standard_normal(count))
        shown += found.p_value is not None and found.p_value < level and found.difference > 0.0
    return shown / PROBLEMS


def _contains(low: float | None, high: float | None, value: float) -> bool:
    return (low is None or low <= value) and (high is None or value <= high)


def _words(log: FloatArray, asked: AskedEffect) -> list[JudgedVariation]:
    """Return the words of variations, given the logarithm of the ratio in each pair, shape (variations, pairs)."""

    def ask(places: Sequence[int], pairs: int) -> list[TriedVariation]:
        return [TriedVariation(_compared(log[place, :pairs])) for place in places]

    return judge_in_looks(ask, len(log), asked)


def _compared(log: FloatArray) -> PairedComparison:
    return compare_paired(np.ones(len(log)), np.exp(log))


def _generators(block: int) -> Sequence[np.random.Generator]:
    return [np.random.default_rng((SEED, block, number)) for number in range(PROBLEMS)]
