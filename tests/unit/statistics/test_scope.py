"""Words of a challenge: each rule, its threshold on both sides, their order, and the looks."""

import numpy as np
import pytest

from runner.statistics import compare_paired
from runner.statistics.conclusion import ALPHA, SHARE, conclusion_sign, least_difference
from runner.statistics.paired import PairedComparison
from runner.statistics.scope import (
    LOOKS,
    AskedEffect,
    TriedVariation,
    came_back,
    first_pairs,
    judge,
    judge_in_looks,
    pairs_of_looks,
)

ASKED = AskedEffect(-1, -0.28)
PAIRS = 12


def pairs_of(effect, scatter=0.0, count=PAIRS, seed=0, **more):
    """Return a comparison of B = (1 + effect) A with normal scatter of the pairs; A is 1."""
    noise = scatter * np.random.default_rng(seed).standard_normal(count)
    found = compare_paired(np.ones(count), 1.0 + effect + noise)
    return PairedComparison(found.a, found.b, found.differences, **more)


def word(found, asked=ASKED, level=ALPHA, **more):
    return judge([TriedVariation(found, **more)], asked, level)[0].word


@pytest.mark.parametrize(
    ("effect", "expected"),
    [(-0.28, "holds"), (-0.15, "holds"), (-0.13, "holds, weaker"), (-0.06, "vanishes"), (0.0, "vanishes"),
     (0.06, "reversed"), (0.5, "reversed")],
)  # fmt: skip
def test_each_word_that_pairs_decide(effect, expected):
    # Bounds: a quarter of 28 % is 7 %, half of it 14 %; "reversed" precedes "vanishes".
    assert word(pairs_of(effect, 1e-4)) == expected


@pytest.mark.parametrize(("effect", "expected"), [(-0.0699, "vanishes"), (-0.0715, "holds, weaker")])
def test_both_sides_of_the_margin(effect, expected):
    assert word(pairs_of(effect, 1e-6)) == expected


def test_the_margin_is_at_least_two_per_cent():
    assert AskedEffect(-1, -0.04).margin == SHARE
    assert AskedEffect(-1, -0.4).margin == pytest.approx(0.1)
    assert AskedEffect(0, 0.4).margin == SHARE


@pytest.mark.parametrize(("effect", "expected"), [(-0.03, "appears"), (0.03, "appears"), (0.01, "does not appear")])
def test_words_of_a_question_without_a_difference(effect, expected):
    assert word(pairs_of(effect, 1e-4), AskedEffect(0, 0.001)) == expected


def test_wide_scatter_is_not_told_and_says_how_many_pairs_would():
    (judged,) = judge([TriedVariation(pairs_of(-0.1, 0.3))], ASKED, ALPHA)
    assert judged.word == "not shown"
    assert judged.needed > PAIRS
    again = [word(pairs_of(-0.1, 0.3, judged.needed, seed)) for seed in range(20)]
    assert again.count("not shown") < 10  # counted for a power of 80 % from one pilot


def test_an_effect_below_the_integration_error_does_not_hold():
    assert word(pairs_of(-0.28, 1e-4, error=0.27)) == "holds"
    assert word(pairs_of(-0.28, 1e-4, error=0.29)) == "not shown"


def test_sides_that_do_not_work_come_first():
    found = pairs_of(0.5, 1e-4)
    assert word(found, spoilt=(0.6, 0.6)) == "neither works"
    assert word(found, spoilt=(0.5, 0.6)) == "reversed"
    assert word(found, spoilt=(0.6, 0.6), reason="no payload") == "cannot be asked"
    assert word(None) == "cannot be asked"
    for side in (0, 1):
        lost = (0.2, 0.7) if side == 0 else (0.7, 0.2)
        (judged,) = judge([TriedVariation(found, lost=lost)], ASKED)
        assert (judged.word, judged.works) == ("only one works", side)


def test_exact_runs_are_compared_without_a_test():
    assert word(pairs_of(-0.28, count=1, exact=True)) == "holds"
    assert word(pairs_of(-0.28, count=1, exact=True, error=0.3)) == "not shown"
    assert word(pairs_of(0.0, count=1, exact=True)) == "vanishes"


def test_a_fraction_is_not_relative():
    asked = AskedEffect(-1, -0.3, is_fraction=True)
    found = compare_paired(np.full(PAIRS, 0.01), np.full(PAIRS, 0.02) + 1e-5 * np.arange(PAIRS))
    assert word(found, asked) == "vanishes"  # 0.01 of a fraction, though twice as large


def test_a_scale_of_the_asked_case_serves_metrics_that_may_be_zero():
    found = compare_paired(np.zeros(PAIRS), np.full(PAIRS, 0.001) + 1e-6 * np.arange(PAIRS))
    assert word(found, AskedEffect(-1, -0.28, scale=1.0)) == "vanishes"
    assert word(found, AskedEffect(-1, -0.28)) == "reversed"


def test_the_family_makes_each_test_stricter():
    found = pairs_of(-0.28, 0.1, 8)  # all of eight pairs have one sign: p = 2 / 2^8
    assert word(found) == "holds"
    assert {one.word for one in judge([TriedVariation(found)] * 20, ASKED)} == {"not shown"}


def test_first_pairs_can_decide_each_variation():
    assert [first_pairs(count) for count in (1, 24, 34)] == [12, 12, 12]
    for count in (35, 100, 200):
        assert 2.0 / 2.0 ** first_pairs(count) < ALPHA / LOOKS / count
    assert pairs_of_looks(12) == [12, 24, 48]


def test_only_variations_that_are_not_told_go_on():
    asked_for = []

    def ask(places, pairs):
        asked_for.append((list(places), pairs))
        effects = {0: (-0.28, 1e-3), 1: (-0.1, 0.08), 2: (0.0, 2.0)}
        return [TriedVariation(pairs_of(*effects[place], pairs)) for place in places]

    words = judge_in_looks(ask, 3, ASKED)
    assert asked_for[0] == ([0, 1, 2], 12)
    assert [pairs for _, pairs in asked_for] == [12, 24, 48]
    assert 0 not in asked_for[1][0]
    assert words[0].word == "holds"
    assert words[0].pairs == 12
    assert words[2].word == "not shown"


def test_a_budget_ends_the_looks_early():
    words = judge_in_looks(lambda places, _: [TriedVariation(pairs_of(-0.28, 1e-3)) for _ in places[:2]], 3, ASKED)
    assert len(words) == 2


def test_the_answer_comes_back_with_the_same_sign_alone():
    assert came_back(pairs_of(-0.28, 0.01), -1, ALPHA) == -1
    assert came_back(pairs_of(0.28, 0.01), -1, ALPHA) is None
    assert came_back(pairs_of(-0.01, 1e-4), -1, ALPHA) is None  # less than 2 %
    assert came_back(pairs_of(-0.01, 1e-4), 0, ALPHA) == 0


def test_the_rule_of_a_conclusion_at_its_threshold():
    found = compare_paired(np.full(PAIRS, 50.0), np.full(PAIRS, 49.0))
    assert least_difference(found) == 1.0
    assert conclusion_sign(found, True) == 0
    assert conclusion_sign(pairs_of(-SHARE - 1e-6), True) == -1
    assert conclusion_sign(pairs_of(-0.5), False) == 0
